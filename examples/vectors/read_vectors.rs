// Reads vectors, and judges a program by them: rustc -O read_vectors.rs && ./read_vectors FOLDER (docs/vectors.md)
use std::{env, fs};

/// A decimal number, or a hexadecimal one such as -0x1.8p+1, which Rust itself does not read.
fn number(word: &str) -> f64 {
    let Some((sign, digits)) = word.split_once("0x") else { return word.parse().unwrap() };
    let (digits, exponent) = digits.split_once('p').unwrap();
    let (whole, fraction) = digits.split_once('.').unwrap();
    let digits = i64::from_str_radix(&format!("{whole}{fraction}"), 16).unwrap() as f64;
    let power = exponent.parse::<i32>().unwrap() - 4 * fraction.len() as i32;
    let half = power / 2; // two factors, so that none overflows
    (if sign == "-" { -1.0 } else { 1.0 }) * digits * 2f64.powi(half) * 2f64.powi(power - half)
}

fn table(path: String) -> Vec<(String, Vec<f64>)> {
    let text = fs::read_to_string(path).unwrap();
    text.lines().skip(1).map(|line| {
        let words: Vec<&str> = line.split(',').collect();
        (words[..2].join(","), words[2..].iter().map(|word| number(word)).collect())
    }).collect()
}

/// Your own: number k of tau, F, N, f, n at a state.
fn program(_state: &[f64], _k: usize) -> f64 {
    0.0
}

fn main() {
    let folder = env::args().nth(1).unwrap();
    let (states, truths) = (table(format!("{folder}/states.csv")), table(format!("{folder}/truth.csv")));
    let (mut numbers, mut difference, mut widest, mut error) = (0, 0f64, 0f64, 0f64);
    for ((key, state), (same, truth)) in states.iter().zip(&truths) {
        assert_eq!(key, same);
        let (m, n) = (state.len() / 2, truth.len() / 4);
        difference += (0..m).map(|k| (state[k] - state[m + k]).abs()).sum::<f64>();
        for k in 0..n {
            let (lower, upper, value) = (truth[2 * n + k], truth[3 * n + k], program(&state[m..], k));
            difference += (lower - truth[k]).abs() + (upper - truth[n + k]).abs();
            let near = lower.abs().min(upper.abs());
            widest = widest.max((upper - lower) / (f64::from_bits(near.to_bits() + 1) - near));
            error = error.max(lower - value).max(value - upper);
        }
        numbers += n;
    }
    println!("rows={} numbers={numbers} difference={difference} widest={widest:.0} error={error:.3}", states.len());
}
