#include "cli/hand/lay_object.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>
#include <string>

#include "core/hand/kinematics.h"
#include "core/hand/scenario.h"
#include "core/world/start_overlap.h"

namespace regrasp::hand {
namespace {

ObjectModel Turned(ObjectModel object, const Matrix3d& R) {
  for (Vector3d& p : object.vertices_O) p = R * p;
  return object;
}

/// A closed box of 12 triangles, along the axes.
ObjectModel BoxOfTriangles(const Vector3d& size) {
  ObjectModel object;
  object.kind = ObjectModel::Kind::kMesh;
  for (int i = 0; i < 8; ++i)
    object.vertices_O.push_back(
        0.5 * size.cwiseProduct(Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  object.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return object;
}

/// Distance of a turn from the nearest that brings axes onto axes.
double OffAxes(const Matrix3d& R) {
  return (R.cwiseAbs() - R.cwiseAbs().unaryExpr([](double r) { return std::round(r); })).norm();
}

// Moments that differ by rounding alone tell no axes: the file's are kept, exactly.
TEST(LayObject, WhereMomentsAreEqualTheBoxLiesAlongTheAxesOfTheFile) {
  for (const char* name : {"zoo_cube_rounded", "zoo_box_tall", "zoo_square", "zoo_hexagon"}) {
    SCOPED_TRACE(name);
    const ObjectModel object = LoadObject(name, ModelSearchPath());
    Vector3d low = object.vertices_O[0], high = low;
    for (const Vector3d& p : object.vertices_O) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const ObjectBox box = BoxOf(object);
    EXPECT_LT(OffAxes(box.R_OB), 1e-12) << box.R_OB;
    EXPECT_LT((box.R_OB * box.size).cwiseAbs().maxCoeff() - (high - low).maxCoeff(), 1e-12);
    EXPECT_NEAR(box.size.prod(), (high - low).prod(), 1e-12);
  }
}

// About equal to a hundredth: a box of 50.0 x 50.2 mm that lies askew by 0.2 degrees.
TEST(LayObject, NearlyEqualMomentsAreEqual) {
  const Matrix3d R = Eigen::AngleAxisd(0.2 * M_PI / 180, Vector3d::UnitZ()).toRotationMatrix();
  const ObjectBox box = BoxOf(Turned(BoxOfTriangles({0.0500, 0.0502, 0.07}), R));
  EXPECT_LT(OffAxes(box.R_OB), 1e-12) << box.R_OB;
}

// A square prism that leans: its long axis is told by the moments, what is about it by the file.
TEST(LayObject, ALeaningPrismIsMeasuredAlongItsAxis) {
  const Matrix3d R = Eigen::AngleAxisd(0.5, Vector3d::UnitX()).toRotationMatrix();
  const ObjectBox box = BoxOf(Turned(BoxOfTriangles({0.04, 0.04, 0.07}), R));
  EXPECT_LT((box.R_OB.transpose() * box.R_OB - Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(box.R_OB.determinant(), 1, 1e-12);
  // x of the file is among its axes, so that the square's sides are.
  EXPECT_LT(OffAxes(R.transpose() * box.R_OB), 1e-9) << box.R_OB;
  EXPECT_NEAR(box.size.maxCoeff(), 0.07, 1e-9);
  EXPECT_NEAR(box.size.minCoeff(), 0.04, 1e-9);
}

TEST(LayObject, ThreeDifferentMomentsTellTheAxesHoweverTheFileIsTurned) {
  const Matrix3d R = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const ObjectBox box = BoxOf(Turned(BoxOfTriangles({0.03, 0.05, 0.08}), R));
  EXPECT_LT(OffAxes(R.transpose() * box.R_OB), 1e-9) << box.R_OB;
  EXPECT_NEAR(box.R_OB.determinant(), 1, 1e-12);
  EXPECT_NEAR(box.size.prod(), 0.03 * 0.05 * 0.08, 1e-12);
}

/// Which way of the hand the box's longest axis points: x, y, z as 0, 1, 2, against them 3, 4, 5.
int LongestAxis(const ObjectBox& box, const Matrix3d& R_WB) {
  int longest = 0, along = 0;
  box.size.maxCoeff(&longest);
  R_WB.col(longest).cwiseAbs().maxCoeff(&along);
  return R_WB(along, longest) > 0 ? along : along + 3;
}

// Six ways to lie, for two along each axis of the hand; the first three along three.
TEST(LayObject, ABoxLiesAlongEveryAxisOfTheHandBeforeItIsTurnedAboutItsOwn) {
  for (const Vector3d& size : {Vector3d(.08, .05, .03), Vector3d(.05, .08, .03)}) {
    const ObjectBox box = BoxOf(BoxOfTriangles(size));
    ASSERT_EQ(box.turns.size(), 6u);
    for (const std::size_t from : {0u, 3u}) {
      std::set<int> axes;
      for (std::size_t k = from; k < from + 3; ++k) axes.insert(LongestAxis(box, box.turns[k]) % 3);
      EXPECT_EQ(axes.size(), 3u) << size.transpose();
    }
  }
}

// A box with a corner drawn out is like itself in no other way: all 24, six directions first.
TEST(LayObject, WhatHasNoSymmetryHas24WaysAndTheFirstSixPointElsewhere) {
  ObjectModel object = BoxOfTriangles({.03, .05, .08});
  object.vertices_O.back() *= 1.1;
  const ObjectBox box = BoxOf(object);
  ASSERT_EQ(box.turns.size(), 24u);
  std::set<int> ways;
  for (std::size_t k = 0; k < 6; ++k) ways.insert(LongestAxis(box, box.turns[k]));
  EXPECT_EQ(ways.size(), 6u);
  for (std::size_t k = 0; k < 24; ++k) {
    EXPECT_NEAR(box.turns[k].determinant(), 1, 1e-12);
    for (std::size_t j = 0; j < k; ++j) EXPECT_GT((box.turns[k] - box.turns[j]).norm(), 1);
  }
}

// The same start counted by hand, way by way.
TEST(LayObject, WaysThatAreClearInMoreStartsComeFirst) {
  LoadedScenario model = LoadScenario("shadow", "", ModelSearchPath());
  model.object = BoxOfTriangles({.03, .04, .075});
  const ObjectBox box = BoxOf(model.object);
  const Vector3d p_WB = model.scenario.X_WO.translation();
  std::vector<Start> starts;
  for (const double moved : {0.0, 0.004, -0.004, 0.008, -0.008})
    for (int axis = 0; axis < 3; ++axis)
      starts.push_back({model.scenario.q_preshape, moved * Vector3d::Unit(axis)});
  const std::vector<Way> ways = WaysToLie(model, box, p_WB, starts);
  ASSERT_FALSE(ways.empty());
  KinematicsData data;
  ForwardKinematics(model.hand, model.scenario.q_preshape, &data);
  const std::vector<Isometry3d> X_WL(
      data.X_WL.begin(), data.X_WL.begin() + static_cast<std::ptrdiff_t>(model.hand.links.size()));
  int before = 0;
  for (const Way& way : ways) {
    EXPECT_LE(DeepestOverlap(model.hand, X_WL, model.object, way.X_WO).depth, kStartOverlap);
    int inside = 0;
    for (const Start& start : starts) {
      Isometry3d X_WO = way.X_WO;
      X_WO.translation() += start.moved;
      inside += DeepestOverlap(model.hand, X_WL, model.object, X_WO).depth > kStartOverlap;
    }
    EXPECT_EQ(way.inside, inside);
    EXPECT_GE(way.inside, before);
    before = way.inside;
    const double off = (way.X_WO * box.p_OB - p_WB).norm();
    EXPECT_TRUE(off < 1e-12 || std::abs(off - 5e-3) < 1e-12) << off;
  }
}

// A cube has one.
TEST(LayObject, AllWaysOfACubeAreOne) {
  EXPECT_EQ(BoxOf(LoadObject("zoo_cube_rounded", ModelSearchPath())).turns.size(), 1u);
}

}  // namespace
}  // namespace regrasp::hand
