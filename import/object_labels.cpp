#include "import/object_labels.h"

#include "base/error.h"
#include "hierarchy/value_channels.h"
#include "import/renumber_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::importing {
namespace {

struct LabelledCorner {
  double label;
  std::uint64_t vertex;
};

double majority(const Triangle<LabelledCorner>& t) {
  return t[1].label == t[2].label ? t[1].label : t[0].label;
}

/// The place of the label in a vertex.
PlacedValue placed_label(const std::string& name, const AttributeLayout& layout) {
  const auto found = std::ranges::find(layout.values, name, &ScalarAttribute::name);
  if (found != layout.values.end() && found->is_label)
    return placed_values(layout)[static_cast<std::size_t>(found - layout.values.begin())];
  std::vector<std::string> there;
  for (const ScalarAttribute& value : layout.values) {
    if (value.is_label)
      there.push_back(value.name);
  }
  throw Error(ErrorCode::input,
              fmt::format("objects.from: the input has no label \"{}\"; {}", name,
                          found != layout.values.end()
                              ? "that value is a quantity, unless \"labels\" names it"
                          : there.empty() ? "there is nothing of that kind"
                                          : fmt::format("there is {}", fmt::join(there, ", "))));
}

/// Gives triangles the numbers of their labels' objects.
class LabelObjects {
 public:
  explicit LabelObjects(MeshObjects& objects) : objects_(objects) {}

  void add(double label) {
    if (!last_ || label != *last_) {
      // Whole labels are written without a fraction, and 0 without a sign; what is no number is
      // none.
      const std::string name = std::isnan(label) ? "" : fmt::format("{}", label + 0.0);
      known_ = objects_.names.number(name, name);
      last_ = label;
    }
    objects_.runs.add(known_, 1);
  }

 private:
  MeshObjects& objects_;
  std::optional<double> last_;
  std::uint32_t known_ = 0;
};

}  // namespace

void find_label_objects(const std::string& name, RawMesh& mesh, const ImportRoom& room) {
  const PlacedValue place = placed_label(name, mesh.layout);
  const std::size_t channels = mesh.channels();
  std::vector<float> rows;
  const auto read = [&](std::uint64_t first, std::span<LabelledCorner> corners) {
    rows.resize(corners.size() * channels);
    mesh.attributes.read(first * channels, rows);
    for (std::size_t i = 0; i < corners.size(); ++i)
      corners[i] = {place.in(rows.data() + i * channels), first + i};
  };
  storage::RecordSpool<Triangle<std::uint32_t>> ordered(room.scratch, kImportSpoolBytes);
  LabelObjects objects(*mesh.objects);
  const auto take = [&](const Triangle<LabelledCorner>& t) {
    objects.add(majority(t));
    ordered.append(Triangle<std::uint32_t>{static_cast<std::uint32_t>(t[0].vertex),
                                           static_cast<std::uint32_t>(t[1].vertex),
                                           static_cast<std::uint32_t>(t[2].vertex)});
  };
  TriangleTranslator<LabelledCorner, decltype(take)> table({0, mesh.vertex_count(), read, false},
                                                           take, room);
  table.add(mesh.triangles);
  table.finish();
  mesh.triangles.clear();
  constexpr std::uint64_t kBlock = 16384;
  std::vector<Triangle<std::uint32_t>> block;
  for (std::uint64_t i = 0; i < ordered.size(); i += block.size()) {
    block.resize(std::min(kBlock, ordered.size() - i));
    ordered.read(i, block);
    mesh.triangles.append(std::span<const Triangle<std::uint32_t>>(block));
  }
}

}  // namespace meshhier::importing
