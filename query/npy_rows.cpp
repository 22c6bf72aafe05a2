#include "query/npy_rows.h"

#include "base/error.h"
#include "base/plain_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <span>
#include <system_error>
#include <vector>

#include <fmt/format.h>

namespace meshhier::querying {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
/// numpy's own limit of a head that it reads unasked is 10,000.
constexpr std::size_t kMostHeadBytes = 65536;
constexpr std::size_t kRowsAtOnce = 65536;

class NpyHead {
 public:
  NpyHead(mesh_io::InputStream& stream, const std::string& name) : name_(name) {
    const std::string front = take(stream, kMagic.size() + 2);
    const int version = front[kMagic.size()];
    if (version < 1 || version > 3)
      fail(fmt::format("version {} of .npy is not read", version));
    const std::string size = take(stream, version == 1 ? 2 : 4);
    std::size_t bytes = 0;
    for (std::size_t i = size.size(); i-- > 0;)
      bytes = bytes << 8 | static_cast<unsigned char>(size[i]);
    if (bytes > kMostHeadBytes)
      fail(fmt::format("its head would have {} bytes", bytes));
    text_ = take(stream, bytes);
  }

  /// Returns the text behind a key, up to the end of the value.
  std::string_view value(std::string_view key, std::string_view end) const {
    const std::size_t place = text_.find(fmt::format("'{}'", key));
    const std::size_t colon = text_.find(':', place == std::string::npos ? text_.size() : place);
    if (colon == std::string::npos)
      fail(fmt::format("its head has no {}", key));
    std::string_view found = std::string_view(text_).substr(colon + 1);
    found = found.substr(0, found.find(end));
    found.remove_prefix(std::min(found.find_first_not_of(' '), found.size()));
    return found;
  }

  /// Returns the numbers of the shape: "(5, 3" as 5 and 3.
  std::vector<std::uint64_t> shape() const {
    std::vector<std::uint64_t> sizes;
    std::string_view left = value("shape", ")");
    while (!left.empty()) {
      left.remove_prefix(std::min(left.find_first_not_of("(, "), left.size()));
      std::uint64_t size = 0;
      const auto [end, error] = std::from_chars(left.data(), left.data() + left.size(), size);
      if (left.empty())
        break;
      if (error != std::errc())
        fail("its shape is wrong");
      sizes.push_back(size);
      left.remove_prefix(static_cast<std::size_t>(end - left.data()));
    }
    return sizes;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::input, fmt::format("{}: {}", name_, what));
  }

 private:
  std::string take(mesh_io::InputStream& stream, std::size_t bytes) const {
    std::string taken(bytes, '\0');
    if (stream.read(std::as_writable_bytes(std::span(taken))) < bytes)
      fail("the .npy ends within its head");
    return taken;
  }

  const std::string& name_;
  std::string text_;
};

/// Returns the number of rows. Throws unless the shape is n x columns.
std::uint64_t rows_of(const NpyHead& head, RowKind kind) {
  const std::vector<std::uint64_t> shape = head.shape();
  if (shape.size() != 2 || shape[1] != columns_of(kind)) {
    head.fail(fmt::format("expected an array of n x {}, found {}", columns_of(kind),
                          plain_text(head.value("shape", ")"), 60) + ")"));
  }
  // A one-dimensional order does not matter.
  if (shape[0] > 1 && !head.value("fortran_order", ",").starts_with("False"))
    head.fail("the array is in Fortran order: save numpy.ascontiguousarray() of it");
  return shape[0];
}

/// A type of numbers, by numpy's name without the order of bytes.
struct NumberType {
  std::string_view name;
  std::size_t size;
  double (*number)(const std::byte*);
};

template <class Number>
constexpr NumberType number_type(std::string_view name) {
  return {name, sizeof(Number), [](const std::byte* bytes) {
            Number number;
            std::memcpy(&number, bytes, sizeof number);
            return static_cast<double>(number);
          }};
}

constexpr std::array kNumberTypes{
    number_type<double>("f8"),       number_type<float>("f4"),
    number_type<std::int8_t>("i1"),  number_type<std::uint8_t>("u1"),
    number_type<std::int16_t>("i2"), number_type<std::uint16_t>("u2"),
    number_type<std::int32_t>("i4"), number_type<std::uint32_t>("u4"),
    number_type<std::int64_t>("i8"), number_type<std::uint64_t>("u8")};

/// Reads the numbers of an array.
class NumberReader {
 public:
  /// Throws Error(input) for an array of anything but numbers.
  explicit NumberReader(const NpyHead& head) {
    const std::string_view type = head.value("descr", ",");
    if (type.starts_with('['))
      head.fail(
          "its rows are records: save numpy.lib.recfunctions.structured_to_unstructured() of it");
    const auto found = std::ranges::find_if(kNumberTypes, [&](const NumberType& known) {
      return type.size() == 5 && std::string_view("<>|").find(type[1]) != std::string_view::npos &&
             type.substr(2, 2) == known.name;
    });
    if (found == kNumberTypes.end()) {
      head.fail(
          fmt::format("expected float64, float32 or integers, found the type {}: save "
                      "array.astype(\"float64\")",
                      plain_text(type, 60)));
    }
    type_ = *found;
    is_swapped_ = type[1] == '>';
  }

  std::size_t size() const { return type_.size; }  ///< bytes of one
  /// Appends the numbers in `bytes`, whole ones, whose order it may turn.
  void append(std::span<std::byte> bytes, std::vector<double>& numbers) const {
    for (; !bytes.empty(); bytes = bytes.subspan(size())) {
      if (is_swapped_)
        std::ranges::reverse(bytes.first(size()));
      numbers.push_back(type_.number(bytes.data()));
    }
  }

 private:
  NumberType type_{};
  bool is_swapped_ = false;  ///< the most significant byte comes first
};

}  // namespace

bool is_npy(std::string_view start) {
  return start.starts_with(kMagic);
}

std::uint64_t read_npy_rows(mesh_io::InputStream& stream, const std::string& name, RowKind kind,
                            const RowVisitor& visit) {
  const NpyHead head(stream, name);
  const NumberReader reader(head);
  const std::size_t row_bytes = reader.size() * columns_of(kind);
  const std::uint64_t rows = rows_of(head, kind);
  std::vector<std::byte> bytes;
  std::vector<double> numbers;
  for (std::uint64_t read = 0; read < rows;) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kRowsAtOnce, rows - read));
    bytes.resize(count * row_bytes);
    if (const std::size_t there = stream.read(bytes); there < bytes.size())
      head.fail(fmt::format("it ends in row {} of {}", read + there / row_bytes, rows));
    numbers.clear();
    reader.append(bytes, numbers);
    visit(numbers);
    read += count;
  }
  bytes.resize(1);
  if (stream.read(bytes) > 0)
    head.fail(fmt::format("there is more behind its {} rows", rows));
  return rows;
}

std::string npy_head(std::string_view type, std::uint64_t count) {
  std::string text =
      fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': ({},), }}", type, count);
  constexpr std::size_t kAlignment = 64, kFront = 10;
  text.append((kAlignment - (kFront + text.size() + 1) % kAlignment) % kAlignment, ' ');
  text += '\n';
  std::string head(kMagic);
  head +=
      {'\x01', '\x00', static_cast<char>(text.size() & 0xff), static_cast<char>(text.size() >> 8)};
  return head + text;
}

}  // namespace meshhier::querying
