#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUtilities.h>

#include "app/results/vtu_files.h"
#include "tests/app/sample_run.h"
#include "tests/app/scratch_directory.h"

namespace hvp::results::deformation_test {
namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> names_in(const std::filesystem::path& directory) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory))
    names.insert(entry.path().filename().string());
  return names;
}

vtkSmartPointer<vtkUnstructuredGrid> read(const std::filesystem::path& path) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}

// Values that single precision can hold, so that they come back exactly.
class DeformationTest : public testing::Test {
 protected:
  DeformationTest() : mesh_(sample::ball(0.05, 2)), anchors_(sample::lowest_nodes(mesh_, 0.2)) {
    for (std::size_t i = 0; i < 3 * mesh_.nodes.size(); ++i)
      displacement_.push_back(1e-3 / static_cast<double>(i + 3));
    for (std::size_t i = 0; i < 6 * mesh_.tetrahedra.size(); ++i) {
      strain_.push_back(static_cast<double>(i) / 1024.0);
      stress_.push_back(-static_cast<double>(i) * 8.0);
    }
    for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e)
      von_mises_.push_back(static_cast<double>(e) + 0.5);
    info_.probe_position_m = {0.01, -0.02, 0.06};
    info_.probe_radius_m = 0.004;
    info_.contact_nodes = contact_;
    info_.contact_force_N = {0.1, 0.2, 0.3};
    info_.strain = strain_;
    info_.stress_Pa = stress_;
    info_.von_mises_Pa = von_mises_;
  }

  void write_two_steps(const std::filesystem::path& directory) {
    DeformationWriter writer(directory, mesh_, anchors_);
    writer.write(0.002, 1, displacement_, info_);
    StepInfo apart = info_;
    apart.contact_nodes = {};
    writer.write(0.1, 50, displacement_, apart);
    writer.finish();
  }

  ScratchDirectory scratch_;
  mesh::TetMesh mesh_;
  std::vector<int> anchors_;
  std::vector<double> displacement_, strain_, stress_, von_mises_;
  std::vector<int> contact_ = {5};
  StepInfo info_;
};

TEST_F(DeformationTest, HasTheRegionOfEachElementWhereThereAreAny) {
  std::vector<int> regions(mesh_.tetrahedra.size(), 0);
  regions[3] = 2;
  {
    DeformationWriter writer(scratch_.path(), mesh_, anchors_, regions);
    writer.write(0.002, 1, displacement_, info_);
  }
  const auto grid = read(scratch_.path() / "deformation_000001.vtu");
  vtkDataArray* found = grid->GetCellData()->GetArray("region");
  ASSERT_NE(found, nullptr);
  for (vtkIdType e = 0; e < grid->GetNumberOfCells(); ++e)
    EXPECT_EQ(found->GetComponent(e, 0), regions[static_cast<std::size_t>(e)]);
  regions.pop_back();
  EXPECT_THROW(DeformationWriter(scratch_.path(), mesh_, anchors_, regions), std::invalid_argument);
  write_two_steps(scratch_.path());
  EXPECT_EQ(read(scratch_.path() / "deformation_000001.vtu")->GetCellData()->GetArray("region"),
            nullptr);
}

TEST_F(DeformationTest, StepReadBackByVtkHoldsEveryArrayAndValue) {
  write_two_steps(scratch_.path());
  const auto grid = read(scratch_.path() / "deformation_000001.vtu");

  ASSERT_EQ(grid->GetNumberOfPoints(), static_cast<vtkIdType>(mesh_.nodes.size()));
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i)
    EXPECT_EQ(Eigen::Vector3d(grid->GetPoint(i)), mesh_.nodes[static_cast<std::size_t>(i)]);
  ASSERT_EQ(grid->GetNumberOfCells(), static_cast<vtkIdType>(mesh_.tetrahedra.size()));
  for (vtkIdType e = 0; e < grid->GetNumberOfCells(); ++e) {
    ASSERT_EQ(grid->GetCellType(e), VTK_TETRA);
    vtkNew<vtkIdList> nodes;
    grid->GetCellPoints(e, nodes);
    for (vtkIdType c = 0; c < 4; ++c)
      EXPECT_EQ(nodes->GetId(c),
                mesh_.tetrahedra[static_cast<std::size_t>(e)][static_cast<std::size_t>(c)]);
  }

  vtkDataArray* displacement = grid->GetPointData()->GetArray("displacement");
  ASSERT_NE(displacement, nullptr);
  ASSERT_EQ(displacement->GetNumberOfComponents(), 3);
  EXPECT_EQ(grid->GetPointData()->GetVectors(), displacement) << "Warp By Vector picks it";
  for (std::size_t i = 0; i < displacement_.size(); ++i)
    EXPECT_EQ(displacement->GetComponent(static_cast<vtkIdType>(i / 3), static_cast<int>(i % 3)),
              displacement_[i]);

  vtkDataArray* anchor = grid->GetPointData()->GetArray("anchor");
  vtkDataArray* contact = grid->GetPointData()->GetArray("contact");
  ASSERT_NE(anchor, nullptr);
  ASSERT_NE(contact, nullptr);
  EXPECT_EQ(anchor->GetDataType(), VTK_UNSIGNED_CHAR);
  EXPECT_EQ(contact->GetDataType(), VTK_UNSIGNED_CHAR);
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    const bool anchored = std::binary_search(anchors_.begin(), anchors_.end(), static_cast<int>(i));
    EXPECT_EQ(anchor->GetComponent(i, 0), anchored ? 1.0 : 0.0) << "node " << i;
    EXPECT_EQ(contact->GetComponent(i, 0), i == 5 ? 1.0 : 0.0) << "node " << i;
  }

  vtkDataArray* strain = grid->GetCellData()->GetArray("strain");
  vtkDataArray* stress = grid->GetCellData()->GetArray("stress");
  vtkDataArray* von_mises = grid->GetCellData()->GetArray("von_mises");
  ASSERT_NE(strain, nullptr);
  ASSERT_NE(stress, nullptr);
  ASSERT_NE(von_mises, nullptr);
  ASSERT_EQ(strain->GetNumberOfComponents(), 6);
  ASSERT_EQ(stress->GetNumberOfComponents(), 6);
  EXPECT_STREQ(stress->GetComponentName(4), "YZ");
  for (std::size_t i = 0; i < strain_.size(); ++i) {
    const auto element = static_cast<vtkIdType>(i / 6);
    const int component = static_cast<int>(i % 6);
    EXPECT_EQ(strain->GetComponent(element, component), strain_[i]);
    EXPECT_EQ(stress->GetComponent(element, component), stress_[i]);
  }
  for (std::size_t e = 0; e < von_mises_.size(); ++e)
    EXPECT_EQ(von_mises->GetComponent(static_cast<vtkIdType>(e), 0), von_mises_[e]);

  vtkFieldData* field = grid->GetFieldData();
  ASSERT_NE(field->GetArray("time_s"), nullptr);
  EXPECT_EQ(field->GetArray("time_s")->GetComponent(0, 0), 0.002);
  ASSERT_NE(field->GetArray("frame"), nullptr);
  EXPECT_EQ(field->GetArray("frame")->GetComponent(0, 0), 1.0);
  ASSERT_NE(field->GetArray("probe_radius_m"), nullptr);
  EXPECT_EQ(field->GetArray("probe_radius_m")->GetComponent(0, 0), 0.004);
  ASSERT_NE(field->GetArray("probe_position_m"), nullptr);
  EXPECT_EQ(Eigen::Vector3d(field->GetArray("probe_position_m")->GetTuple3(0)),
            info_.probe_position_m);
  ASSERT_NE(field->GetArray("contact_force_N"), nullptr);
  EXPECT_EQ(Eigen::Vector3d(field->GetArray("contact_force_N")->GetTuple3(0)),
            info_.contact_force_N);
}

TEST_F(DeformationTest, AStepWithoutContactMarksNoNode) {
  write_two_steps(scratch_.path());
  const auto grid = read(scratch_.path() / "deformation_000050.vtu");
  EXPECT_EQ(grid->GetPointData()->GetArray("contact")->GetRange()[1], 0.0);
}

TEST_F(DeformationTest, TwoWritesGiveTheSameBytes) {
  ScratchDirectory other;
  write_two_steps(scratch_.path());
  write_two_steps(other.path());
  const auto names = names_in(scratch_.path());
  EXPECT_EQ(names, names_in(other.path()));
  for (const std::string& name : names)
    EXPECT_EQ(bytes_of(scratch_.path() / name), bytes_of(other.path() / name)) << name;
}

TEST_F(DeformationTest, FilesHoldNoPath) {
  write_two_steps(scratch_.path());
  for (const std::string& name : names_in(scratch_.path()))
    EXPECT_EQ(bytes_of(scratch_.path() / name).find(scratch_.path().string()), std::string::npos);
}

TEST_F(DeformationTest, ListNamesEveryStepWithItsTime) {
  write_two_steps(scratch_.path());
  const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(
      vtkXMLUtilities::ReadElementFromFile((scratch_.path() / "deformation.pvd").c_str()));
  ASSERT_NE(root, nullptr);
  EXPECT_STREQ(root->GetAttribute("type"), "Collection");
  vtkXMLDataElement* collection = root->FindNestedElementWithName("Collection");
  ASSERT_NE(collection, nullptr);
  ASSERT_EQ(collection->GetNumberOfNestedElements(), 2);
  EXPECT_STREQ(collection->GetNestedElement(0)->GetAttribute("timestep"), "0.002");
  EXPECT_STREQ(collection->GetNestedElement(0)->GetAttribute("file"), "deformation_000001.vtu");
  EXPECT_STREQ(collection->GetNestedElement(1)->GetAttribute("timestep"), "0.1");
  EXPECT_STREQ(collection->GetNestedElement(1)->GetAttribute("file"), "deformation_000050.vtu");
}

TEST_F(DeformationTest, TheListComesOnlyWithFinish) {
  DeformationWriter writer(scratch_.path(), mesh_, anchors_);
  writer.write(0.0, 0, displacement_, info_);
  EXPECT_EQ(names_in(scratch_.path()), std::set<std::string>{"deformation_000000.vtu"});
  writer.finish();
  EXPECT_EQ(names_in(scratch_.path()),
            (std::set<std::string>{"deformation.pvd", "deformation_000000.vtu"}));
}

TEST_F(DeformationTest, AnEarlierRunsStepsGoAndOtherFilesStay) {
  write_two_steps(scratch_.path());
  for (const char* name : {"deformation_.vtu", "deformation_12345x.vtu", "notes.vtu"})
    std::ofstream(scratch_.path() / name) << "mine";
  std::ofstream(scratch_.path() / "deformation_000007.vtu.part") << "half";
  DeformationWriter writer(scratch_.path(), mesh_, anchors_);
  EXPECT_EQ(names_in(scratch_.path()),
            (std::set<std::string>{"deformation_.vtu", "deformation_12345x.vtu", "notes.vtu"}));
}

TEST_F(DeformationTest, RefusesWhatDoesNotFitTheMesh) {
  const std::vector<int> beyond = {static_cast<int>(mesh_.nodes.size())};
  EXPECT_THROW(DeformationWriter(scratch_.path(), mesh_, beyond), std::invalid_argument);

  DeformationWriter writer(scratch_.path(), mesh_, anchors_);
  const std::span<const double> u(displacement_);
  EXPECT_THROW(writer.write(0.0, 0, u.first(u.size() - 1), info_), std::invalid_argument);
  StepInfo wrong = info_;
  wrong.contact_nodes = beyond;
  EXPECT_THROW(writer.write(0.0, 0, u, wrong), std::invalid_argument);
  const std::vector<int> before = {-2};
  wrong.contact_nodes = before;
  EXPECT_THROW(writer.write(0.0, 0, u, wrong), std::invalid_argument);
  wrong = info_;
  wrong.strain = wrong.strain.first(6);
  EXPECT_THROW(writer.write(0.0, 0, u, wrong), std::invalid_argument);
  writer.write(0.0, 3, u, info_);
  EXPECT_THROW(writer.write(0.0, 3, u, info_), std::invalid_argument) << "frames ascend";
}

TEST_F(DeformationTest, ADirectoryThatIsNotThereIsAnErrorWithItsName) {
  std::filesystem::path gone = scratch_.path() / "gone";
  try {
    DeformationWriter writer(gone, mesh_, anchors_);
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("gone"), std::string::npos);
  }
}

TEST_F(DeformationTest, AFailedWriteLeavesNoPartFile) {
  const auto target = scratch_.path() / "mesh.vtu";
  std::filesystem::create_directories(target / "occupied");
  EXPECT_THROW(write_mesh(target, mesh_, {von_mises_, von_mises_}), std::runtime_error);
  EXPECT_EQ(names_in(scratch_.path()), std::set<std::string>{"mesh.vtu"});
}

TEST_F(DeformationTest, MeshFileHoldsTheQualityOfEveryElement) {
  const std::vector<double> angle = von_mises_;
  std::vector<double> aspect(angle.size(), 1.5);
  aspect.back() = 3.25;
  const auto path = scratch_.path() / "mesh.vtu";
  write_mesh(path, mesh_, {angle, aspect});
  const auto grid = read(path);
  ASSERT_EQ(grid->GetNumberOfCells(), static_cast<vtkIdType>(angle.size()));
  ASSERT_NE(grid->GetCellData()->GetArray("min_dihedral_angle_deg"), nullptr);
  ASSERT_NE(grid->GetCellData()->GetArray("aspect_ratio"), nullptr);
  for (std::size_t e = 0; e < angle.size(); ++e) {
    const auto cell = static_cast<vtkIdType>(e);
    EXPECT_EQ(grid->GetCellData()->GetArray("min_dihedral_angle_deg")->GetComponent(cell, 0),
              angle[e]);
    EXPECT_EQ(grid->GetCellData()->GetArray("aspect_ratio")->GetComponent(cell, 0), aspect[e]);
  }
  EXPECT_THROW(write_mesh(path, mesh_, {angle, std::span(aspect).first(1)}), std::invalid_argument);
}

// VTK's own choices of width follow the machine and the data's size; ours must not.
TEST_F(DeformationTest, HeaderStatesFixedWidthsAndCompressor) {
  write_two_steps(scratch_.path());
  const std::string file = bytes_of(scratch_.path() / "deformation_000001.vtu");
  EXPECT_NE(file.find("<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
                      "byte_order=\"LittleEndian\" header_type=\"UInt32\" "
                      "compressor=\"vtkZLibDataCompressor\">"),
            std::string::npos)
      << file.substr(0, 400);
  EXPECT_NE(file.find("<DataArray type=\"Int32\" Name=\"connectivity\""), std::string::npos);
}

}  // namespace
}  // namespace hvp::results::deformation_test
