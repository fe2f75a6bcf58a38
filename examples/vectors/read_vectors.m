% Reads vectors, and judges a program by them, in MATLAB or Octave: read_vectors('FOLDER') (docs/vectors.md)
function read_vectors(folder)
  [keys, x] = table_of(fullfile(folder, 'states.csv'));
  [same, y] = table_of(fullfile(folder, 'truth.csv'));
  assert(isequal(keys, same));
  m = size(x, 2) / 2; n = size(y, 2) / 4;
  lower = y(:, 2*n+1:3*n); upper = y(:, 3*n+1:4*n);
  difference = sum(sum(abs(x(:, 1:m) - x(:, m+1:2*m)))) + sum(sum(abs(y(:, 1:2*n) - y(:, 2*n+1:4*n))));
  widest = max(max((upper - lower) ./ eps(min(abs(lower), abs(upper)))));
  value = program(x(:, m+1:2*m));
  err = max(max(max(max(lower - value, value - upper), 0)));
  fprintf('rows=%d numbers=%d difference=%g widest=%.0f error=%.3f\n', size(y, 1), numel(lower), difference, widest, err);
end

function value = program(states)  % your own: from q, v, a and payload to tau, F, N, f, n in the order of the table
  value = 0;
end

function [keys, numbers] = table_of(path)
  lines = strsplit(strtrim(fileread(path)), '\n');
  keys = {}; numbers = [];
  for k = 2:numel(lines)
    words = strsplit(strtrim(lines{k}), ',');
    half = (numel(words) - 2) / 2;
    keys(end+1, :) = words(1:2);
    numbers(end+1, :) = [cellfun(@str2double, words(3:2+half)), cellfun(@hexadecimal, words(3+half:end))];
  end
end

function x = hexadecimal(word)  % such as -0x1.8p+1
  t = regexp(word, '0x(\w)\.(\w+)p(.+)$', 'tokens', 'once');
  power = str2double(t{3}) - 4 * numel(t{2});
  x = (1 - 2 * (word(1) == '-')) * hex2dec([t{1} t{2}]) * 2^fix(power / 2) * 2^(power - fix(power / 2));
end
