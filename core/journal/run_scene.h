#pragma once

/// A run as viewers of MCAP files draw it: messages of the public schemas foxglove.FrameTransforms
/// and foxglove.SceneUpdate (docs.foxglove.dev). The root frame is W; links have their own names,
/// the object's frame is O. Internal to this folder.

#include <nlohmann/json.hpp>

#include "core/journal/run_messages.h"

namespace regrasp::scene {

using Json = nlohmann::ordered_json;

inline constexpr double kArrowPerNewton = 0.02;  ///< length of a force's arrow [m/N]

Json TransformsSchema();
Json SceneSchema();
/// {sec, nsec}, and its schema.
Json Time(std::uint64_t time_ns);
Json TimeSchema();

/// The pose of every link and of the object by the truth. Coupled joints stand where their drivers
/// put them.
Json Transforms(const Frame& frame, const RunPlace& place);
/// The shapes of links and object, each fixed to its frame.
Json Shapes(const RunPlace& place);
/// Every true contact of the object as a ball, its force on the object as an arrow from there.
Json Contacts(const Frame& frame, const RunPlace& place);

}  // namespace regrasp::scene
