# Reads vectors, and judges a program by them: julia read_vectors.jl FOLDER (docs/vectors.md)
using Printf

function table(path)
    rows = [split(line, ',') for line in readlines(path)[2:end]]
    [row[1:2] for row in rows], permutedims(reduce(hcat, [parse.(Float64, row[3:end]) for row in rows]))  # hex too
end

program(states) = 0.0  # your own: from q, v, a and payload, a row each, to tau, F, N, f, n in the order of the table

keys, x = table(joinpath(ARGS[1], "states.csv"))
same, y = table(joinpath(ARGS[1], "truth.csv"))
@assert keys == same
m, n = size(x, 2) ÷ 2, size(y, 2) ÷ 4
lower, upper = y[:, 2n+1:3n], y[:, 3n+1:4n]
difference = sum(abs.(x[:, 1:m] - x[:, m+1:2m])) + sum(abs.(y[:, 1:2n] - y[:, 2n+1:4n]))
widest = maximum((upper - lower) ./ eps.(min.(abs.(lower), abs.(upper))))
value = program(x[:, m+1:2m])
error = maximum(max.(lower .- value, value .- upper, 0.0))
@printf("rows=%d numbers=%d difference=%g widest=%.0f error=%.3f\n", size(y, 1), length(lower), difference, widest, error)
