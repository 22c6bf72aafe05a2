// Tells a query in words.
#include "base/plain_text.h"
#include "query/query.h"

#include <fmt/format.h>

namespace meshhier::querying {

std::string query_text(const QuerySummary& summary) {
  const bool are_points = summary.kind == RowKind::points;
  std::string text = counted(summary.rows, are_points ? "points" : "rays");
  if (!are_points)
    text += fmt::format(", {}", counted(summary.hits, "hits"));
  if (summary.least)
    text += fmt::format("; distances {:.6g} to {:.6g}", *summary.least, *summary.largest);
  text += fmt::format("; {} of {} read\n", summary.tiles_read, counted(summary.tiles, "tiles"));
  if (summary.error_bound > 0)
    text += fmt::format("the surface is at most {:.6g} from its original\n", summary.error_bound);
  if (summary.not_asked > 0)
    text += fmt::format("{}: the answer is nan\n",
                        are_points ? counted(summary.not_asked, "points") + " without a place"
                                   : counted(summary.not_asked, "rays") + " that lead nowhere");
  if (summary.unknown_sides > 0)
    text += fmt::format(
        "of {} the side is not known: the nearest place is on a border of the "
        "surface, or it is no manifold there\n",
        counted(summary.unknown_sides, "points"));
  return text;
}

nlohmann::ordered_json query_json(const QuerySummary& summary) {
  using Json = nlohmann::ordered_json;
  const auto number = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json();
  };
  Json object{{"hierarchy", summary.name},
              {"index_checksum", summary.index_checksum},
              {"rows", summary.rows},
              {"not_asked", summary.not_asked},
              {"least", number(summary.least)},
              {"largest", number(summary.largest)},
              {"error_bound", summary.error_bound},
              {"tiles", summary.tiles},
              {"tiles_read", summary.tiles_read}};
  if (summary.kind == RowKind::rays)
    object["hits"] = summary.hits;
  else
    object["unknown_sides"] = summary.unknown_sides;
  return object;
}

}  // namespace meshhier::querying
