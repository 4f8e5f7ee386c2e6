#pragma once

/// The physical truth: hand and object simulated with ODE. Only the session, the sensors and the
/// judges (job records, pictures, tests) may include this file; the controller's libraries do not
/// link it.
///
/// Honest physics: outside the stand-in (SetStandIn, on only before a grasp is complete) and a
/// user's push (SetPush) nothing but contact friction and gravity acts on the object.

#include <memory>
#include <optional>
#include <string_view>

#include "core/common/fields.h"
#include "core/common/frames.h"
#include "core/common/limits.h"
#include "core/hand/hand_model.h"
#include "core/hand/object_model.h"
#include "core/world/contact_solver.h"
#include "core/world/start_overlap.h"

namespace regrasp {

enum class Stepper {
  kFast,   ///< the same equations in joint coordinates (fast_step.h)
  kExact,  ///< dWorldStep: the reference
  kRound,  ///< the fast step with the friction cone instead of ODE's pyramid, which is up to √2 as
           ///< strong along its diagonals
};
inline constexpr Stepper kLastStepper = Stepper::kRound;
std::string_view Name(Stepper stepper);                      ///< "fast", "exact", "round"
std::optional<Stepper> StepperNamed(std::string_view name);  ///< nothing for another word

struct WorldConfig {
  double dt = 1e-3;  ///< step [s]
  Stepper stepper = Stepper::kFast;
  ContactSolverLimits contact_solver;  ///< fast step
  double contact_stiffness = 4000;     ///< [N/m]
  double contact_damping = 8;          ///< [N s/m]
  double joint_erp = 0.5;    ///< exact: share of a joint's position error removed per step
  double joint_cfm = 1e-10;  ///< ODE's softness of the joint and friction rows [m/(N s)]
  bool merge_universal =
      true;  ///< perpendicular joint pairs sharing an anchor become one universal joint
};

/// One contact of the object, with whatever it touches.
struct ObjectContact {
  int link = -1;                     ///< link of the hand
  int finger = -1;                   ///< whose fingertip it is; -1: what else a hand has, beside a
                                     ///< fingertip on its link, too
  Vector3d p_WC = Vector3d::Zero();  ///< [m]
  Vector3d normal_W = Vector3d::UnitZ();  ///< outward normal of the object
  Vector3d force_W = Vector3d::Zero();    ///< on the object, of the last step [N]
  double depth = 0;                       ///< penetration [m]
  template <typename V>
  void Fields(V& v) {
    v("link", link, FieldRange{0, kMaxLinks - 1});
    v("finger", finger, v.Finger());
    v("p_WC", p_WC);
    v("normal_W", normal_W);
    v("force_W", force_W);
    v("depth", depth);
  }
};

/// Everything the simulator knows after a step.
struct WorldState {
  JointVector q;       ///< joint angles [rad]
  JointVector qdot;    ///< joint rates [rad/s]
  JointVector torque;  ///< torques applied by the drives, after the effort limit [N m]
  Vector3d p_WO = Vector3d::Zero();  ///< [m]
  Quaterniond q_WO = Quaterniond::Identity();
  Vector3d v_WO = Vector3d::Zero();  ///< [m/s]
  Vector3d w_WO = Vector3d::Zero();  ///< [rad/s]
  FixedVector<ObjectContact, kMaxObjectContacts> contacts;
  int link_link_contacts = 0;  ///< contacts of hand links with each other
  template <typename V>
  void Fields(V& v) {
    v("q", q);
    v("qdot", qdot);
    v("torque", torque);
    v("p_WO", p_WO);
    v("q_WO", q_WO);
    v("v_WO", v_WO);
    v("w_WO", w_WO);
    v("contacts", contacts);
    v("link_link_contacts", link_link_contacts);
  }
};

/// The bodies of the exact step, as ODE keeps them; nothing with the fast step, which makes them
/// anew from WorldState.
struct BodyMemory {
  struct Body {
    Vector3d p_W = Vector3d::Zero();  ///< centre of mass [m]
    Eigen::Vector4d wxyz = Eigen::Vector4d::Unit(0);
    Matrix3d R_WB = Matrix3d::Identity();
    Vector3d v_W = Vector3d::Zero(), w_W = Vector3d::Zero();
    template <typename V>
    void Fields(V& v) {
      v("p_W", p_W);
      v("wxyz", wxyz);
      v("R_WB", R_WB);
      v("v_W", v_W);
      v("w_W", w_W);
    }
  };
  FixedVector<Body, kMaxLinks + 1> bodies;  ///< of the hand, then the object
  bool held = false;                        ///< the stand-in has the object since a step
  Body held_at;                             ///< where it took it
  template <typename V>
  void Fields(V& v) {
    v("bodies", bodies);
    v("held", held);
    v("held_at", held_at);
  }
};

/// All numbers of a world that decide its future.
struct WorldMemory {
  bool faulted = false;
  WorldState state;
  JointVector torque;  ///< asked for [N m]
  Vector3d push_W = Vector3d::Zero(), gravity_W = Vector3d::Zero();
  double friction = 0, mass = 0;
  bool stand_in = true;
  BodyMemory bodies;
  template <typename V>
  void Fields(V& v) {
    v("faulted", faulted, FieldRange{0, 0});
    v("state", state);
    v("torque", torque);
    v("push_W", push_W, kUnbounded);
    v("gravity_W", gravity_W);
    v("friction", friction);
    v("mass", mass);
    v("stand_in", stand_in);
    v("bodies", bodies);
  }
};

enum class StepStatus { kOk, kFault };

class World {
 public:
  /// Builds the world at rest: joints at `q0` [rad], the object at `X_WO0`, in the stand-in's hold.
  World(const HandModel& hand, const ObjectModel& object, const WorldConfig& config,
        const JointVector& q0, const Isometry3d& X_WO0);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Drive torques for the coming steps [N m], clamped to each joint's effort. Viscous damping of
  /// the model and the joint stops act in addition. Non-finite values are a fault at the next step.
  void SetTorque(const JointVector& torque);
  /// The stand-in holds the object where it is now (true) or lets go (false).
  void SetStandIn(bool on);
  bool stand_in() const;
  /// Force on the object at its centre, in W [N], until changed.
  void SetPush(const Vector3d& force_W);
  void SetGravity(const Vector3d& gravity_W);  ///< [m/s²]
  void SetFriction(double coefficient);        ///< (0, 1]
  void SetMass(double mass_kg);                ///< > 0; the inertia scales with it

  /// Advances by dt. Never throws and never ends the process: a fault inside ODE makes this and
  /// every later call return kFault, and only destroying the world helps. `fault_message()` tells
  /// the reason and what may help, `fault_cause()` the reason alone.
  StepStatus Step();
  const char* fault_message() const;
  const char* fault_cause() const;

  /// The truth after the last step (or the initial state).
  const WorldState& state() const;
  double mass_kg() const;
  double friction() const;
  const Vector3d& gravity_W() const;

  /// What the object overlapped when the world was built.
  const StartOverlap& start_overlap() const;

  /// Largest distance by which the two bodies of a joint have come apart at its anchor [m]: how
  /// well the stepper keeps the hand together.
  double JointDrift() const;

  /// Seconds the last step spent in collision detection and in the ODE stepper; 0 unless `on`.
  struct StageTimes {
    double collide_s = 0, step_s = 0;
  };
  void MeasureStages(bool on);
  StageTimes stage_times() const;

  WorldMemory Memory() const;
  /// Goes on from there. False, and nothing changes, where it is of another hand or stepper, or
  /// this world has faulted.
  bool Remember(const WorldMemory& memory);
  template <typename V>
  void Fields(V& v) {
    WorldMemory memory = Memory();
    memory.Fields(v);
    if constexpr (V::kLoads)
      if (!Remember(memory)) v.Refuse("bodies", "are of another hand or stepper");
  }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace regrasp
