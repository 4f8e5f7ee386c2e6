#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "bench/peers/engine.h"

namespace regrasp::bench {
namespace {

std::ostream& operator<<(std::ostream& out, const Vector3d& v) {
  return out << v.x() << ' ' << v.y() << ' ' << v.z();
}

/// The scene as MJCF. Geometries are named by their link, "L7", and the object's "O".
class Mjcf {
 public:
  Mjcf(const LoadedScenario& model, const Isometry3d& X_WO, const Vector3d& gravity_W)
      : hand_(model.hand) {
    out_.precision(17);
    out_ << "<mujoco><compiler angle='radian' inertiafromgeom='false' boundmass='1e-6' "
            "boundinertia='1e-9'/><option timestep='0.001' solver='Newton' gravity='"
         << gravity_W << "'/><default><geom contype='1' conaffinity='2' friction='"
         << model.object.friction << " 0 0' condim='3'/></default><worldbody>";
    Shapes(0);
    Children(0);
    const ObjectModel& object = model.object;
    if (object.kind != ObjectModel::Kind::kSphere && object.kind != ObjectModel::Kind::kBox)
      throw std::runtime_error("MuJoCo: only spheres and boxes");
    out_ << "<body name='object' pos='" << X_WO.translation() << "'><freejoint/>";
    Inertial(object.mass, Vector3d::Zero(), object.I_OCom);
    out_ << "<geom name='O' contype='2' conaffinity='1' ";
    if (object.kind == ObjectModel::Kind::kSphere)
      out_ << "type='sphere' size='" << object.radius << "'";
    else
      out_ << "type='box' size='" << object.half_extents << "'";
    out_ << "/></body></worldbody></mujoco>";
  }
  std::string text() const { return out_.str(); }

 private:
  void Inertial(double mass, const Vector3d& p, const Matrix3d& I) {
    out_ << "<inertial pos='" << p << "' mass='" << mass << "' fullinertia='" << I(0, 0) << ' '
         << I(1, 1) << ' ' << I(2, 2) << ' ' << I(0, 1) << ' ' << I(0, 2) << ' ' << I(1, 2)
         << "'/>";
  }
  void Shapes(int link) {
    for (const Shape& s : hand_.links[link].shapes) {
      out_ << "<geom name='L" << link << '_' << geoms_++ << "' ";
      if (s.kind == Shape::Kind::kBox) {
        const Quaterniond q(s.X_LB.linear());
        out_ << "type='box' size='" << s.half_extents << "' pos='" << s.X_LB.translation()
             << "' quat='" << q.w() << ' ' << q.vec() << "'/>";
      } else if ((s.b_L - s.a_L).norm() < 1e-9) {
        out_ << "type='sphere' size='" << s.radius << "' pos='" << s.a_L << "'/>";
      } else {
        out_ << "type='capsule' size='" << s.radius << "' fromto='" << s.a_L << ' ' << s.b_L
             << "'/>";
      }
    }
  }
  void Children(int link) {
    for (std::size_t j = 0; j < hand_.joints.size(); ++j) {
      const Joint& joint = hand_.joints[j];
      if (joint.parent_link != link) continue;
      const Quaterniond q(joint.X_PJ.linear());
      const Link& child = hand_.links[joint.child_link];
      out_ << "<body pos='" << joint.X_PJ.translation() << "' quat='" << q.w() << ' ' << q.vec()
           << "'>";
      Inertial(child.mass, child.p_LCom, child.I_LCom);
      out_ << "<joint name='J" << j << "' type='hinge' axis='" << joint.axis_J
           << "' limited='true' range='" << joint.lower << ' ' << joint.upper << "' damping='"
           << joint.damping << "' armature='" << joint.armature << "'/>";
      Shapes(joint.child_link);
      Children(joint.child_link);
      out_ << "</body>";
    }
  }

  const HandModel& hand_;
  int geoms_ = 0;
  std::ostringstream out_;
};

class Mujoco : public Engine {
 public:
  Mujoco(const LoadedScenario& model, const JointVector& q0, const Isometry3d& X_WO,
         const Vector3d& gravity_W)
      : X_WO_(X_WO), q_(q0) {
    const std::string text = Mjcf(model, X_WO, gravity_W).text();
    mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "scene.xml", static_cast<int>(text.size()));
    std::copy(text.begin(), text.end(),
              static_cast<char*>(files.filedata[mj_findFileVFS(&files, "scene.xml")]));
    std::array<char, 500> error{};
    model_ = mj_loadXML("scene.xml", &files, error.data(), error.size());
    mj_deleteVFS(&files);
    if (!model_) throw std::runtime_error(std::string("MuJoCo: ") + error.data());
    data_ = mj_makeData(model_);
    for (int i = 0; i < q0.size(); ++i) {
      const int joint = mj_name2id(model_, mjOBJ_JOINT, ("J" + std::to_string(i)).c_str());
      position_.push_back(model_->jnt_qposadr[joint]);
      rate_.push_back(model_->jnt_dofadr[joint]);
      data_->qpos[position_.back()] = q0[i];
    }
    object_ = mj_name2id(model_, mjOBJ_BODY, "object");
    free_position_ = model_->jnt_qposadr[model_->body_jntadr[object_]];
    free_rate_ = model_->jnt_dofadr[model_->body_jntadr[object_]];
    finger_of_geom_.assign(static_cast<std::size_t>(model_->ngeom), -1);
    for (int g = 0; g < model_->ngeom; ++g) {
      const std::string name = mj_id2name(model_, mjOBJ_GEOM, g);
      for (int f = 0; f < model.hand.num_fingers(); ++f)
        if (name.starts_with("L" + std::to_string(model.hand.fingers[f].tip_link) + "_"))
          finger_of_geom_[static_cast<std::size_t>(g)] = f;
    }
  }
  ~Mujoco() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }

  void Step(const JointVector& torque, bool held) override {
    for (int i = 0; i < q_.size(); ++i) data_->qfrc_applied[rate_[i]] = torque[i];
    if (held) Hold();
    mj_step(model_, data_);
    for (int i = 0; i < q_.size(); ++i) q_[i] = data_->qpos[position_[i]];
  }
  const JointVector& q() const override { return q_; }
  Vector3d p_WO() const override {
    return Eigen::Map<const Vector3d>(data_->qpos + free_position_);
  }
  Quaterniond q_WO() const override {
    const double* q = data_->qpos + free_position_ + 3;
    return {q[0], q[1], q[2], q[3]};
  }
  std::vector<Touch> touches() const override {
    std::vector<Touch> found;
    for (int c = 0; c < data_->ncon; ++c) {
      const mjContact& contact = data_->contact[c];
      const int finger = std::max(finger_of_geom_[static_cast<std::size_t>(contact.geom1)],
                                  finger_of_geom_[static_cast<std::size_t>(contact.geom2)]);
      if (finger < 0) continue;
      std::array<mjtNum, 6> force{};
      mj_contactForce(model_, data_, c, force.data());
      found.push_back({finger, Eigen::Map<const Vector3d>(contact.pos), force[0]});
    }
    return found;
  }
  double joint_drift() const override { return 0; }  // joint coordinates

 private:
  void Hold() {
    const Quaterniond q(X_WO_.linear());
    double* p = data_->qpos + free_position_;
    for (int k = 0; k < 3; ++k) p[k] = X_WO_.translation()[k];
    p[3] = q.w();
    for (int k = 0; k < 3; ++k) p[4 + k] = q.vec()[k];
    for (int k = 0; k < 6; ++k) data_->qvel[free_rate_ + k] = 0;
  }

  Isometry3d X_WO_;
  JointVector q_;
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  std::vector<int> position_, rate_, finger_of_geom_;
  int object_ = 0, free_position_ = 0, free_rate_ = 0;
};

}  // namespace

std::unique_ptr<Engine> MakeMujoco(const LoadedScenario& model, const JointVector& q0,
                                   const Isometry3d& X_WO, const Vector3d& gravity_W) {
  return std::make_unique<Mujoco>(model, q0, X_WO, gravity_W);
}

}  // namespace regrasp::bench
