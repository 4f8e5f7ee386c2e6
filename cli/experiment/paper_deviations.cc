#include "cli/experiment/paper_deviations.h"

#include <fmt/format.h>

#include <string_view>

#include "cli/client/errors.h"
#include "cli/grammar/grammar.h"
#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

/// {NAME} is the value of a parameter, {NAME*F} that value times F.
constexpr const char* kDeviations = R"(
| where | the paper | here, and why |
|---|---|---|
| line 2 | start gradient N(0, 0.15), no unit | two tangential components, times ∇max = {exploration.gradient_max} /m: 0.15 /m would vanish beside the gradients met |
| line 3 | stop at ‖P T⁻¹ ∇̃φ‖ ≤ ε | for {exploration.converged_updates} updates in a row, as one estimate may merely cross zero; what points into a wall is removed first. ε = {exploration.epsilon} /m and N_max = {exploration.max_cycles} cycles are ours |
| line 4 | every n cycles | also not before the contact has moved {exploration.min_displacement*1e3} mm: a secant over less is noise. n = {exploration.update_cycles} is ours |
| line 5 | Δc = P T (c′ − c) | the inverse of T: as printed it turns a displacement in r the wrong way |
| line 6 | component-wise secant | offered as `secant`; the default fits the gradient by least squares over the recent past, with a circular dither |
| line 7 | limit to ∇max | ∇max = {exploration.gradient_max} /m is ours |
| line 3, 11 | P, T at the contact | the contact is placed on the fingertip's known surface by its sensed normal: 2° of normal noise move it less than 1 mm of position noise |
| line 11 | a displacement η ∇̃φ | a velocity, held to {exploration.speed_min*1e3} … {exploration.speed_max*1e3} mm/s: slower, friction stops the finger; with least squares the dither keeps it moving, and the least speed falls with a gradient below ε. η = {exploration.eta} m²/s is ours |
| Alg. 1 | reference frame r | W, the fixed palm's frame |
| Alg. 1 | φ in no unit | manipulability sqrt(det J Jᵀ) in 1e-4 m³, so that φ is of order 1 |
| Alg. 1 | no bound | at most {exploration.max_excursion*1e3} mm from the start; joint limits, the other fingers, the end of the round fingertip and the object beside it are walls; a finger on the side of its last link, where the contact does not follow it, slides onto the round end first; with least squares the search also ends after {exploration.no_gain_s} s without a gain, and there are a return to the best φ met and up to three tries |
| Sec. II | grasp stability, no formula | smallest singular value of the grasp matrix, torques over the mean contact distance; others can be chosen |
| Sec. II | a minimal threshold | {control.stability_threshold}, ours; back to manipulability 5 % above it |
| Fig. 2 | linear sum, no weights | φ + {exploration.stability_weight} σ_min |
| Sec. II | hybrid controller of earlier work | object wrench by PI on the sensed pose, friction-cone QP for contact forces, joint torques by Jᵀf, posture springs in the null space. A sliding finger: force along the normal ({exploration.normal_force} N, less where the load margin asks), velocity with friction feedforward across it |
| Sec. II | the object is in the hand | a stand-in holds it while the hand closes, and lets go before anything is measured |
| Sec. III | Vortex | ODE at 1 kHz |
| Sec. III | noise of a real sensor, no numbers | presets; `paper` is 1 mm, 2°, 0.05 N, joints 0.3°, object 1 mm and 1°; contact normals and joint angles are noisy, too |
| Sec. III | one start | each seed has its own start: joints σ {start.joint_sigma_rad*57.29578}°, object σ {start.object_sigma_m*1e3} mm |
| Fig. 1 | Shadow Hand model of [8] | 22 joints, links as capsules, one drive per joint |
| Sec. III | sphere of 5 cm | 80 g, friction 0.8 |
| Sec. III b | S_L, S_R, S_M, S_F, S_T | the same order; the opposing finger is found from the contact normals and is always last |
| Sec. III b | a fixed gait | a finger leaves only while the others keep a load margin of {gait.margin_min} N; contacts that let the thumb leave ({gait.margin_wanted} N) are sought first |
| Sec. III b | the free finger explores | for at most {gait.explore_s} s, within {gait.disc_radius*1e3} mm of its first contact, from the gradient with which its last exploration ended |
| Sec. III b | fingers slide to new contacts | they hop back to where they first touched, then slide while they explore. That is `gait.preset paper`; by default they do not explore, and come back to where the surface as felt says the grasp goes on best (`planned`) |
)";

}  // namespace

std::string PaperDeviations(const Json& parameters) {
  std::string text;
  std::string_view rest = kDeviations;
  for (std::size_t open = rest.find('{'); open != rest.npos; open = rest.find('{')) {
    const std::size_t close = rest.find('}', open);
    const std::string field(rest.substr(open + 1, close - open - 1));
    const std::size_t times = field.find('*');
    const std::string name = field.substr(0, times);
    const Json& value = At(parameters, name.c_str());
    if (!value.is_number())
      throw CliError(kFailed, fmt::format("the daemon has no parameter {}", name));
    const double factor =
        times == field.npos ? 1 : ParseNumber(field.substr(times + 1), "a deviation's factor");
    text += rest.substr(0, open);
    text += fmt::format("{:.4g}", value.get<double>() * factor);
    rest.remove_prefix(close + 1);
  }
  return text + std::string(rest);
}

}  // namespace regrasp::cli
