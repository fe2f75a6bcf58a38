// Reads vectors, and judges a program by them: g++ -std=c++17 -O2 read_vectors.cpp && ./a.out FOLDER (docs/vectors.md)
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

using Rows = std::vector<std::vector<double>>;

Rows table(const std::string& path, std::vector<std::string>& keys) {  // strtod reads hexadecimal numbers too
    std::ifstream file(path);
    std::string line, word, level, state;
    Rows rows;
    for (std::getline(file, line); std::getline(file, line);) {
        std::stringstream words(line);
        std::getline(words, level, ',');
        std::getline(words, state, ',');
        keys.push_back(level + "," + state);
        rows.emplace_back();
        while (std::getline(words, word, ',')) rows.back().push_back(std::strtod(word.c_str(), nullptr));
    }
    return rows;
}

double program(const std::vector<double>&, std::size_t) { return 0.0; }  // your own; number k of tau, F, N, f, n

int main(int count, char** arguments) {
    std::vector<std::string> keys, same;
    const std::string folder = count > 1 ? arguments[1] : ".";
    const Rows states = table(folder + "/states.csv", keys), truths = table(folder + "/truth.csv", same);
    if (keys.empty() || keys != same) return std::fprintf(stderr, "%s has no vectors\n", folder.c_str()), 1;
    double difference = 0, widest = 0, error = 0;
    std::size_t numbers = 0;
    for (std::size_t row = 0; row < states.size(); ++row) {
        const std::size_t m = states[row].size() / 2, n = truths[row].size() / 4;
        for (std::size_t k = 0; k < m; ++k) difference += std::abs(states[row][k] - states[row][m + k]);
        const std::vector<double> state(states[row].begin() + m, states[row].end());
        for (std::size_t k = 0; k < n; ++k, ++numbers) {
            const double lower = truths[row][2 * n + k], upper = truths[row][3 * n + k], value = program(state, k);
            difference += std::abs(lower - truths[row][k]) + std::abs(upper - truths[row][n + k]);
            const double near = std::min(std::abs(lower), std::abs(upper));
            widest = std::max(widest, (upper - lower) / (std::nextafter(near, INFINITY) - near));
            error = std::max({error, lower - value, value - upper});
        }
    }
    std::printf("rows=%zu numbers=%zu difference=%g widest=%.0f error=%.3f\n", states.size(), numbers, difference, widest,
                error);
}
