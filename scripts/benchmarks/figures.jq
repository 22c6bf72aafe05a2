# Figures and rows of the tables that benchmarks print.

def decimals($count): . * pow(10; $count) | round / pow(10; $count);

# Three of them.
def digits:
  if . == 0 then 0 else pow(10; (log10 | floor) - 2) as $step | . / $step | round * $step | decimals(7) end;

def row: "| \(map(tostring) | join(" | ")) |";
