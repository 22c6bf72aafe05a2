# The tables of the benchmark `scale`, in Markdown: sizes, budgets, threads, methods, order.
#
# Input: one object a build, as `meshhier build --stats` writes it, with .copy_seconds and .setting: triangles, shuffled, method,
# threads, budget (bytes). The first build has the usual budget.
# $meshes: what was built. $gains: {"2": 1.9}, of a loop that only computes, by threads. $triangles, $method, $threads: what the
# tables vary one thing of.

def ratio($by): if $by > 0 then . / $by else 0 end;

# A number >= 0 with so many decimals, > 0.
def fixed($decimals):
  (. * pow(10; $decimals) | round | tostring)
  | ("0" * ($decimals + 1 - length) // "") + .
  | .[:-$decimals] + "." + .[-$decimals:];

def millions: . / 1e6 | fixed(if . < 0.1 then 3 elif . < 9.95 then 2 else 1 end) + " M";

# Three digits: "1.46 GiB".
def size:
  reduce ("KiB", "MiB", "GiB", "TiB") as $unit ({value: ., unit: "B"};
    if .value < 1024 then . else {value: (.value / 1024), $unit} end)
  | if .unit == "B" or .value >= 100 then "\(.value | round) \(.unit)"
    else "\(.value | fixed(if . < 10 then 2 else 1 end)) \(.unit)" end;

# "512MiB", as it is asked for.
def budget:
  if . % 1073741824 == 0 then "\(. / 1073741824)GiB" elif . % 1048576 == 0 then "\(. / 1048576)MiB" else tostring end;

# The columns of a build.
def cells:
  .setting as $setting | .total as $total
  | {
      triangles: ($setting.triangles | millions),
      "wall s": ($total.wall_seconds | fixed(2)),
      "CPU s": ($total.cpu_seconds | fixed(2)),
      "CPU µs/triangle": ($total.cpu_seconds * 1e6 | ratio($setting.triangles) | fixed(3)),
      "M triangles/s": ($setting.triangles | ratio($total.wall_seconds * 1e6) | fixed(2)),
      budget: ($setting.budget | budget),
      "peak memory": ($total.peak_resident_bytes | size),
      "peak/budget": ($total.peak_resident_bytes | ratio($setting.budget) | fixed(2)),
      "moved/floor": (.floor_bytes as $floor | .moved_bytes | ratio($floor) | fixed(2)),
      temporary: (if .peak_temporary_bytes == 0 then "-" else .peak_temporary_bytes | size end),
      "temporary/(in + out)": (.floor_bytes as $floor | .peak_temporary_bytes | ratio($floor) | fixed(2)),
      "predicted/temporary": (if .peak_temporary_bytes == 0 then "-"
        else .predicted_temporary_bytes / .peak_temporary_bytes | fixed(2) end),
      output: (.output_bytes | size),
      "predicted/output": (.output_bytes as $output | .predicted_output_bytes | ratio($output) | fixed(2)),
      "plain copy s": (.copy_seconds | fixed(2)),
      "wall/copy": (.copy_seconds as $copy | $total.wall_seconds | ratio($copy) | fixed(1)),
      method: $setting.method,
      order: (if $setting.shuffled then "random" else "own" end),
      versus: .versus
    };

def line: "| \(join(" | ")) |\n";

# Rows that are builds; the last column may be named "versus: TITLE".
def table($title; $columns):
  if length == 0 then "" else
    "### \($title)\n\n" + ($columns | map(ltrimstr("versus: ")) | line) + "|\($columns | map("---:|") | add)\n"
    + (map(cells as $cells | $columns | map(if startswith("versus: ") then $cells.versus else $cells[.] end) | line) | add) + "\n"
  end;

# .versus: the wall time of each against the build of the same size for which is_reference holds.
def versus(is_reference):
  . as $rows
  | map(. as $row | .versus = (
      [$rows[] | select(.setting.triangles == $row.setting.triangles and (.setting | is_reference))]
      | if length == 0 then "-" else .[0].total.wall_seconds as $wall | $row.total.wall_seconds | ratio($wall) | fixed(2) end));

if length == 0 then "Meshes: \($meshes). Nothing was built.\n" else
  {$triangles, shuffled: false, $method, $threads, budget: .[0].setting.budget} as $usual
  | ($usual.budget | budget) as $budget
  | def rows_that_differ_in(path):
      map(select((.setting | del(path)) == ($usual | del(path))))
      | sort_by(.setting | [.triangles, .shuffled, .method, .threads, .budget]);
    def thread_table:
      if length < 2 then "" else
        .[0] as $one | .[1:] as $more
        | "### Threads (\($triangles | millions) triangles, \($budget))\n\n"
          + (["stage", "\($one.setting.threads) thread: wall s"]
            + [$more[] | "\(.setting.threads) threads: wall s", "gain"] | line)
          + "|---|---:|\($more | map("---:|---:|") | add)\n"
          + ($one.stages | map(. as $stage | [.name, (.wall_seconds | fixed(2))]
            + [$more[] | ((.stages[] | select(.name == $stage.name) | .wall_seconds) // 0) as $wall
              | ($wall | fixed(2)), ($stage.wall_seconds | ratio($wall) | fixed(2))] | line) | add)
          + (["**whole build**", ($one.total.wall_seconds | fixed(2))]
            + [$more[] | .total.wall_seconds as $wall
              | ($wall | fixed(2)), ($one.total.wall_seconds | ratio($wall) | fixed(2))] | line)
          + (["a loop that only computes", ""]
            + [$more[] | "", ($gains[.setting.threads | tostring] // 0 | fixed(2))] | line) + "\n"
      end;
    rows_that_differ_in(.triangles) as $sizes
  | rows_that_differ_in(.triangles, .budget) as $budgets
  | rows_that_differ_in(.method) as $methods
  | rows_that_differ_in(.triangles, .shuffled) as $orders
  | "Meshes: \($meshes).\n\n"
    + ($sizes | table("Sizes (\($method), \($budget), \($threads) threads)";
        ["triangles", "wall s", "CPU s", "CPU µs/triangle", "M triangles/s", "peak memory", "peak/budget", "moved/floor", "output",
         "predicted/output", "plain copy s", "wall/copy"]))
    + (if ($budgets | length) == ($sizes | length) then "" else $budgets | table("Budgets (\($method), \($threads) threads)";
        ["triangles", "budget", "wall s", "CPU s", "peak memory", "peak/budget", "moved/floor", "temporary", "temporary/(in + out)",
         "predicted/temporary"]) end)
    + (rows_that_differ_in(.threads) | thread_table)
    + (if ($methods | length) < 2 then "" else $methods | versus(.method == "edge_collapse")
        | table("Methods (\($triangles | millions) triangles)";
          ["method", "wall s", "CPU s", "CPU µs/triangle", "M triangles/s", "versus: wall/edge_collapse"]) end)
    + (if ($orders | any(.setting.shuffled) | not) then "" else $orders | versus(.shuffled | not)
        | table("Order of vertices and faces (\($method), \($budget), \($threads) threads)";
          ["triangles", "order", "wall s", "CPU s", "CPU µs/triangle", "peak/budget", "moved/floor", "versus: wall/own"]) end)
end
