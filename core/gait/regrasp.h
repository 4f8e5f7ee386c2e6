#pragma once

/// One finger gives up its contact and takes another one while the others hold: load transfer, the
/// way (a hop or a slide) to its target in the palm, Algorithm 1 there if wanted, and load transfer
/// back. Load transfer and exploration are a guided slide (core/exploration/guided_slide.h).

#include "core/exploration/guided_slide.h"
#include "core/gait/gait_parameters.h"
#include "core/gait/hop.h"

namespace regrasp {

class Regrasp {
 public:
  enum class Phase : std::uint8_t {
    kIdle,
    kUnload,   ///< its force ramps down, the others take over
    kLift,     ///< off the surface
    kAcross,   ///< above the surface, to above the target
    kDown,     ///< until it touches
    kSeek,     ///< nothing there: towards the object's centre
    kGoBack,   ///< nor there: to above where it left, then down again
    kSlide,    ///< over the surface to the target, or towards it before a hop; or
    kSettle,   ///< explore: presses with the exploring force until the filters follow
    kRecall,   ///< explore: slides to where the finger's last explorations ended
    kExplore,  ///< Algorithm 1
    kReturn,   ///< back to the best contact it met, if the last one is worse
    kReload,   ///< its force ramps up
    kDone,
  };

  struct Request {
    GuidedSlide::Request slide;  ///< finger, objective, seed; `leaves` is always true
    bool hop = true;             ///< otherwise it slides
    bool explore = false;
    bool over_surface = false;  ///< a hop keeps above the felt surface, and a miss is sought
    double transfer_s = 0.03;   ///< load transfer before it leaves [s]
    double rub_s = 0;           ///< slides so long towards its target before it hops [s]
    double disc_share = 1;  ///< explore: of gait.disc_radius, within which the new contact may be
    template <typename V>
    void Fields(V& v) {
      v("slide", slide);
      v("hop", hop);
      v("explore", explore);
      v("disc_share", disc_share);
      v("over_surface", over_surface);
      v("transfer_s", transfer_s);
      v("rub_s", rub_s);
    }
  };
  /// Where the finger shall go, in W; follows the object: its reference position, or where the
  /// landing is planned its estimated pose, noise and all.
  struct Target {
    Vector3d p_WC = Vector3d::Zero();       ///< contact [m]
    Vector3d p_WF = Vector3d::Zero();       ///< fingertip centre [m]
    Vector3d normal_W = Vector3d::UnitZ();  ///< outward
    /// Explore: slides here first, where the last explorations ended [m]; not where the landing is
    /// planned.
    std::optional<Vector3d> p_WR;
    Vector3d p_WO = Vector3d::Zero();  ///< the object's centre, about which a hop is an arc [m]
    Vector3d w_W = Vector3d::Zero();   ///< of the object, with which the target turns [rad/s]
  };

  void Start(const Request& request);
  /// Back into the grasp by the shortest way.
  void Abort();
  /// One tick; changes the task of this finger only.
  void Update(const ControlTick& tick, const Target& target, HybridController* controller,
              FingerTasks* tasks);

  const Request& request() const { return request_; }
  int finger() const { return request_.slide.finger; }
  Phase phase() const;
  /// Slides before it hops, to feel the friction.
  bool rubs() const {
    return slide_.phase() == GuidedSlide::Phase::kAway && request_.hop &&
           hop_.phase() == Hop::Phase::kIdle;
  }
  /// Slides with its exploring force.
  bool explores() const {
    return slide_.phase() >= GuidedSlide::Phase::kSettle &&
           slide_.phase() <= GuidedSlide::Phase::kReturn;
  }
  bool active() const { return slide_.active(); }
  bool aborted() const { return aborted_; }
  /// Found no surface to stand on.
  bool no_surface() const { return slide_.no_surface(); }
  const GuidedSlide& slide() const { return slide_; }
  template <typename V>
  void Fields(V& v) {
    v("request", request_);
    v("aborted", aborted_);
    v("slide_ticks", slide_ticks_);
    v("slide", slide_);
    v("hop", hop_);
  }

 private:
  /// Away from its old contact: one tick of the way to the target.
  void Travel(const ControlTick& tick, const Target& target, FingerTask* task);
  /// Over the surface towards the target; true when it is there, or has tried for long enough.
  bool SlideOver(const ControlTick& tick, const Target& target, FingerTask* task);

  Request request_;
  bool aborted_ = false;
  int slide_ticks_ = 0;  // of the slide to the target
  GuidedSlide slide_;
  Hop hop_;
};

std::string_view Name(Regrasp::Phase phase);  ///< "unload", "lift", ...

}  // namespace regrasp
