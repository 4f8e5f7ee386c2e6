#pragma once

/// What is made of a mesh and never changes, made once for all that use it at a time: a world that
/// is restored shares it with the one it follows, and with what is drawn and judged besides.

#include <Eigen/Core>
#include <cstring>
#include <memory>
#include <mutex>
#include <vector>

#include "core/common/frames.h"

namespace regrasp {

/// T is made of (vertices, triangles), which stay where they are as long as it lives.
template <typename T>
class LastMesh {
 public:
  /// The one that was asked for last, if it is still in use and of the same mesh to the last bit;
  /// else a new one. Any thread.
  std::shared_ptr<const T> Of(const std::vector<Vector3d>& vertices,
                              const std::vector<Eigen::Vector3i>& triangles) {
    {
      const std::lock_guard lock(mutex_);
      const std::shared_ptr<const Made> last = last_.lock();
      if (last && Same(last->vertices, vertices) && Same(last->triangles, triangles))
        return {last, &last->made};
    }
    const auto made = std::make_shared<const Made>(vertices, triangles);
    const std::lock_guard lock(mutex_);
    last_ = made;
    return {made, &made->made};
  }

 private:
  struct Made {
    Made(const std::vector<Vector3d>& v, const std::vector<Eigen::Vector3i>& t)
        : vertices(v), triangles(t), made(vertices, triangles) {}
    const std::vector<Vector3d> vertices;
    const std::vector<Eigen::Vector3i> triangles;
    const T made;
  };

  template <typename Row>
  static bool Same(const std::vector<Row>& a, const std::vector<Row>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Row)) == 0;
  }

  std::mutex mutex_;
  std::weak_ptr<const Made> last_;
};

}  // namespace regrasp
