#include "core/hand/mesh_units.h"

#include <fmt/format.h>

namespace regrasp {
namespace {

struct Unit {
  const char* name;
  double metres;
};
constexpr Unit kUnits[] = {{"millimetres", 0.001}, {"centimetres", 0.01}, {"inches", 0.0254}};

std::string UnitsFor(double size, double least, double most) {
  std::string text;
  for (const Unit& unit : kUnits)
    if (size * unit.metres >= least && size * unit.metres <= most)
      text += fmt::format("{0} in {1}: <mesh scale=\"{2:g} {2:g} {2:g}\">",
                          text.empty() ? "; if the file is" : ",", unit.name, unit.metres);
  return text;
}

}  // namespace

std::string UnitHint(double size, double least, double most) {
  const std::string plausible = UnitsFor(size, 5e-3, 0.2);
  return plausible.empty() ? UnitsFor(size, least, most) : plausible;
}

}  // namespace regrasp
