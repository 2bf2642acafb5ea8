#include "stage_times.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace tactree::builder {
namespace {

TEST(StageTimes, MeasuresEachStep) {
  Progress quiet;
  Usage usage{10.0, 1.0, 100};
  StageTimes times(quiet, [&] { return usage; });
  times.set_points(7);  // before the first step
  usage = {11.0, 1.5, 100};
  times.begin("one");
  times.set_points(3);
  usage = {13.0, 4.5, 300};
  times.begin("two");
  usage = {13.5, 5.0, 200};
  times.end();
  times.end();
  usage = {20.0, 9.0, 900};
  ASSERT_EQ(times.stages().size(), 2U);
  const StageReport& one = times.stages()[0];
  EXPECT_EQ(one.name, "one");
  EXPECT_EQ(one.seconds, 2.0);
  EXPECT_EQ(one.cpu_seconds, 3.0);
  EXPECT_EQ(one.points, 3U);
  EXPECT_EQ(one.peak_rss_bytes, 300U);
  const StageReport& two = times.stages()[1];
  EXPECT_EQ(two.seconds, 0.5);
  EXPECT_EQ(two.cpu_seconds, 0.5);
  EXPECT_EQ(two.points, 0U);
  EXPECT_EQ(two.peak_rss_bytes, 200U);
  EXPECT_EQ(times.seconds(), 10.0);
}

TEST(StageTimes, AreReportedByBuild) {
  Progress quiet;
  std::vector<Scan> scans;
  scans.push_back(cloud_scan(without_normals(random_sphere(3000, 0.03))));
  const BuildReport report = build_model(std::move(scans), {}, quiet).report;
  ASSERT_GE(report.stages.size(), 5U);
  EXPECT_EQ(report.stages.front().name, "cleaning");
  EXPECT_EQ(report.stages.front().points, report.input_points);
  EXPECT_EQ(report.stages.back().name, "writing the octree");
  double sum = 0.0;
  for (const StageReport& stage : report.stages) {
    EXPECT_GE(stage.seconds, 0.0);
    EXPECT_GE(stage.cpu_seconds, 0.0);
    EXPECT_GT(stage.points, 0U);
    EXPECT_LE(stage.peak_rss_bytes, report.peak_rss_bytes);
    sum += stage.seconds;
  }
  EXPECT_LE(sum, report.seconds);
}

}  // namespace
}  // namespace tactree::builder
