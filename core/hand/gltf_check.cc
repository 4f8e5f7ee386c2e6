#include "core/hand/gltf_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <vector>

namespace regrasp {
namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "as the numbers of the file");

/// The JSON chunk of a .glb file of version 2; discarded where there is none.
Json Description(const std::string& file) {
  struct {
    char magic[4];
    std::uint32_t version, length, chunk_length;
    char chunk_kind[4];
  } head{};
  std::ifstream in(file, std::ios::binary);
  const Json none(Json::value_t::discarded);
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error || !in.read(reinterpret_cast<char*>(&head), sizeof(head))) return none;
  if (std::memcmp(head.magic, "glTF", 4) != 0 || head.version != 2 ||
      std::memcmp(head.chunk_kind, "JSON", 4) != 0 || head.chunk_length > size)
    return none;
  std::string text(head.chunk_length, '\0');
  if (!in.read(text.data(), static_cast<std::streamsize>(text.size()))) return none;
  return Json::parse(text, nullptr, false);
}

/// Of looks, or one that Debian's assimp reads.
bool IsKnown(std::string_view extension) {
  constexpr std::string_view kBegins[] = {
      "KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_",
      "KHR_lights_",    "EXT_lights_",  "KHR_xmp",      "KHR_draco_mesh_compression"};
  return std::ranges::any_of(kBegins, [&](auto begin) { return extension.starts_with(begin); });
}

/// `object`[key] where it is an array, else an empty one.
const Json& Array(const Json& object, const char* key) {
  static const Json kEmpty = Json::array();
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found != object.end() && found->is_array() ? *found : kEmpty;
}

bool HasCornersThatAreNoFloats(const Json& gltf) {
  constexpr int kFloat = 5126;
  const Json& accessors = Array(gltf, "accessors");
  for (const Json& mesh : Array(gltf, "meshes"))
    for (const Json& primitive : Array(mesh, "primitives")) {
      const Json::json_pointer position("/attributes/POSITION");
      if (!primitive.contains(position) || !primitive[position].is_number_unsigned()) continue;
      const auto index = primitive[position].get<std::size_t>();
      if (index < accessors.size() && accessors[index].is_object() &&
          accessors[index].value("componentType", Json(kFloat)) != Json(kFloat))
        return true;
    }
  return false;
}

}  // namespace

std::string WhyNoGltf(const std::string& file) {
  const Json gltf = Description(file);
  std::vector<std::string> unknown;
  for (const Json& extension : Array(gltf, "extensionsRequired"))
    if (extension.is_string() && !IsKnown(extension.get<std::string>()))
      unknown.push_back(extension.get<std::string>().substr(0, 64));
  constexpr std::string_view kWithout =
      "export it without compression (of gltfpack: -noq, and not -c)";
  if (!unknown.empty())
    return fmt::format("requires the glTF extension {}, which is not read; {}",
                       fmt::join(unknown, ", "), kWithout);
  if (HasCornersThatAreNoFloats(gltf))
    return fmt::format("its corners are no floats (glTF componentType 5126); {}", kWithout);
  return "";
}

}  // namespace regrasp
