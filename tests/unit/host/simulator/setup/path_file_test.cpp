#include "tactree/setup/path_file.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <utility>

#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/support/csv.hpp"

namespace tactree::test {
namespace {

using simulation::HandPath;

class PathFile : public FolderTest {
 protected:
  HandPath read(const std::string& text) const {
    return setup::read_path_file(write("path.csv", text));
  }
  std::string refusal(const std::string& text) const {
    return message_of<std::runtime_error>([&] { read(text); })
        .substr((folder_ / "path.csv").string().size());
  }
};

TEST_F(PathFile, ReadsHeadingsAndComments) {
  const HandPath path =
      read("t_s,x,y,z\r\n# comment\n\n0, 0.1,0.2,0.3\r\n0.5,0.2,0.2,0.3\n1,0.2,0.4,-3e-1");
  ASSERT_EQ(path.waypoints().size(), 3U);
  EXPECT_EQ(path.waypoints()[2].position_m, Eigen::Vector3d(0.2, 0.4, -0.3));
  const plant::HandTarget target = path.at(0.25);
  EXPECT_NEAR(target.position_m.x(), 0.15, 1e-12);
  EXPECT_NEAR(target.velocity_m_s.x(), 0.2, 1e-12);
  EXPECT_EQ(path.at(-1.0).position_m.x(), 0.1);
  EXPECT_EQ(path.at(-1.0).velocity_m_s.norm(), 0.0);
  EXPECT_EQ(path.at(1.0).position_m.z(), -0.3);
  EXPECT_EQ(path.at(9.0).velocity_m_s.norm(), 0.0);
}

TEST_F(PathFile, FindsColumnsByName) {
  for (const char* const text : {"t, x_m, y_m, z_m\n0,1,2,3\n", "z,name,y,time_s,x\n3,9,2,0,1\n",
                                 "t_s;X;Y;Z\n0;1;2;3\n", "0 1 2 3\n"}) {
    const HandPath path = read(text);
    ASSERT_EQ(path.waypoints().size(), 1U) << text;
    EXPECT_EQ(path.waypoints()[0].t_s, 0.0) << text;
    EXPECT_EQ(path.waypoints()[0].position_m, Eigen::Vector3d(1.0, 2.0, 3.0)) << text;
  }
}

TEST_F(PathFile, ErrorsStatePlaceAndRemedy) {
  const std::string row =
      " (each row is t_s,x,y,z in seconds and metres, or has a value for each name)";
  EXPECT_EQ(refusal("0,0,0,0\n1,0,0\n"), ": line 2: 3 values instead of 4" + row);
  EXPECT_EQ(refusal("0,0,0,0\n1,0,0,0,0\n"), ": line 2: 5 values instead of 4" + row);
  EXPECT_EQ(refusal("t_s,x,y,z,n\n1,0,0,0\n"), ": line 2: 4 values instead of 5" + row);
  EXPECT_EQ(refusal("0,0,0,0\n1,0,nan,0\n"), ": line 2: column 3 is not finite: 'nan'");
  EXPECT_EQ(refusal("0,0,0,0\n1,0,inf,0\n"), ": line 2: column 3 is not finite: 'inf'");
  EXPECT_EQ(refusal("0,0,0,0\n1,0,0x1,0\n"), ": line 2: column 3 is not a number: '0x1'");
  EXPECT_EQ(refusal("0,0,0,0\n1,,0,0\n"), ": line 2: column 2 is not a number: ''");
  EXPECT_EQ(refusal("t_s,x,y,z\nt_s,x,y,z\n0,0,0,0\n"),
            ": line 2: column 1 (t_s) is not a number: 't_s'");
  for (const auto& [names, missing] : {std::pair{"t_ms,x,y,z", "t_s"},
                                       {"t_s,x_mm,y_mm,z_mm", "x"},
                                       {"t_s,x,z", "y"},
                                       {"a,b", "t_s"}}) {
    EXPECT_EQ(refusal(std::string(names) + "\n0,0,0,0\n"),
              std::string(": line 1: no column is named ") + missing +
                  " (name them, in seconds and metres, or omit the line of names)");
  }
  EXPECT_EQ(refusal("0,0,0,0\n0,0,0,0\n"),
            ": line 2: the time does not ascend (sort the rows by t_s)");
  EXPECT_EQ(refusal(""), ": has no waypoint (write rows t_s,x,y,z)");
  EXPECT_EQ(refusal("t_s,x,y,z\n"), ": has no waypoint (write rows t_s,x,y,z)");
  EXPECT_THROW((void)setup::read_path_file("/nonexistent/path.csv"), support::CsvError);
}

}  // namespace
}  // namespace tactree::test
