// Promise 6: the output is byte-identical on any x86-64 processor. Other processors are played by
// hiding features of this one from the C library, which then takes other variants of its functions.
#include "storage/io/hash.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

namespace fs = std::filesystem;

/// As of before 2013: neither fused multiplication nor vectors of more than 16 bytes.
const std::string kOldProcessor =
    "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX,-AVX2,-AVX512F,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable ";

/// Returns the output of a command; its failure fails the test.
std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr)
    return text;
  std::array<char, 4096> part{};
  for (std::size_t n = 1; n > 0;) {
    n = std::fread(part.data(), 1, part.size(), pipe);
    text.append(part.data(), n);
  }
  EXPECT_EQ(::pclose(pipe), 0) << command;
  return text;
}

/// Degrees at which the library's functions differ between this processor and the old one: none if
/// the feature is hidden in vain.
std::vector<std::string> degrees_that_differ() {
  std::istringstream now(output_of(MESHHIER_LIBM_VALUES));
  std::istringstream then(output_of(kOldProcessor + MESHHIER_LIBM_VALUES));
  std::vector<std::string> found;
  for (std::string a, b; std::getline(now, a) && std::getline(then, b);) {
    if (a != b)
      found.push_back(a.substr(0, a.find(' ')));
  }
  return found;
}

using FileHashes = std::map<std::string, std::uint64_t>;

FileHashes hashes_of(const fs::path& directory) {
  FileHashes hashes;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    if (!entry.is_regular_file())
      continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    hashes[entry.path().lexically_relative(directory).string()] =
        storage::checksum(std::as_bytes(std::span(bytes)));
  }
  return hashes;
}

class ProcessorsTest : public testing::Test {
 protected:
  void SetUp() override {
    degrees_ = degrees_that_differ();
    if (degrees_.empty())
      GTEST_SKIP() << "the C library has the same functions for this processor and an old one";
  }

  FileHashes build(const std::string& processor, const fs::path& mesh, const std::string& name,
                   const std::string& settings) const {
    const fs::path output = directory_.path() / name;
    output_of(processor + MESHHIER_BINARY + " build --progress none --set input=" + mesh.string() +
              " output=" + output.string() + " threads=1 partition.vertices=500 " + settings +
              " 2>&1");
    return hashes_of(output);
  }

  void expect_equal(const std::string& name, const tests::TestMesh& mesh,
                    const std::string& settings) const {
    const fs::path path = directory_.path() / (name + ".ply");
    tests::write_ply(mesh, path);
    expect_equal(name, path, settings);
  }

  void expect_equal(const std::string& name, const fs::path& path,
                    const std::string& settings) const {
    const FileHashes now = build("", path, name + "_now.hier", settings);
    EXPECT_GT(now.size(), 10U);
    EXPECT_EQ(build(kOldProcessor, path, name + "_then.hier", settings), now) << name;
  }

  std::vector<std::string> degrees_;
  tests::TemporaryDirectory directory_;
};

TEST_F(ProcessorsTest, AModelOnTheGlobeStandsTheSame) {
  for (const std::string& degrees : degrees_) {
    if (std::abs(std::stod(degrees)) <= 90)
      return expect_equal("globe", tests::open_grid(40, 40, 0.3F),
                          "placement.longitude=" + degrees + " placement.latitude=" + degrees);
  }
  GTEST_SKIP() << "the C library's variants agree on all latitudes";
}

// At these places PROJ's own results differ in the last bit; the transform is rounded.
TEST_F(ProcessorsTest, AModelOnAMapStandsTheSame) {
  const std::map<std::string, std::string> places = {{"EPSG:32633", "[450337,5319317,300]"},
                                                     {"EPSG:2056", "[2600000,1225893,300]"},
                                                     {"EPSG:27700", "[401011,200822,300]"},
                                                     {"EPSG:31468", "[4450000,5336579,300]"}};
  for (const auto& [crs, offset] : places) {
    expect_equal(
        crs, tests::open_grid(40, 40, 0.3F),
        "up=z placement.anchor=[0,0,0] placement.crs=" + crs + " placement.offset=" + offset);
  }
}

TEST_F(ProcessorsTest, EveryMethodMakesTheSame) {
  for (const std::string method : {"edge_collapse", "half_edge", "cluster"})
    expect_equal(method, tests::sphere(40000, 0.004F), "simplify.method=" + method);
}

TEST_F(ProcessorsTest, SLOW_AScanIsTheSame) {
  const fs::path model = fs::path(MESHHIER_MODELS_DIR) / "bunny_range.ply";
  if (!fs::exists(model))
    GTEST_SKIP() << "no " << model << ": real scans are not there";
  expect_equal("scan", model, "simplify.vertices=500");
}

TEST_F(ProcessorsTest, CutsByAxesAreTheSame) {
  expect_equal("axis", tests::sphere(40000, 0.004F), "partition.axis=longest");
}

}  // namespace
}  // namespace meshhier
