#pragma once

/// The commands of the daemon as data. One table makes the daemon's validation, `describe`, the
/// command line's help and completion, docs/protocol.md and the protocol tests.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace regrasp {

/// Limits of the wire (docs/protocol.md: Lines, Requests, Slow clients).
inline constexpr std::size_t kMaxRequestBytes = 64 * 1024;  ///< of one line, without its line end
inline constexpr int kMaxRequestDepth = 32;                 ///< nested arrays and objects
inline constexpr std::size_t kMaxBatch = 32;                ///< requests per line
inline constexpr std::size_t kMaxIdBytes = 64;              ///< of a string id
inline constexpr double kMaxSafeInteger = 9007199254740992.0;  ///< 2^53: ids, seeds, job numbers
inline constexpr double kMaxMoveOffset = 0.05;                 ///< of one `move` [m]
inline constexpr std::size_t kMaxOutputBytes = 1024 * 1024;    ///< unread output before eviction
inline constexpr int kMaxOutputStallSeconds = 10;              ///< without progress before eviction

enum class ParamType : std::uint8_t {
  kInteger,  ///< a JSON number without fraction
  kNumber,
  kBool,
  kString,
  kEnum,            ///< a string out of `values`, or of the names that `names` refers to
  kVector3,         ///< three numbers
  kParameterValue,  ///< a number, three numbers, true, false or a word
  kObject,          ///< names and values
  kIntegerPair,     ///< two integers
};
std::string_view Name(ParamType type);  ///< as `describe` prints it: "integer", "number[3]", ...

/// Names that only a running daemon knows.
enum class NameSource : std::uint8_t {
  kNone,
  kFinger,
  kObject,
  kParameter,
  kParameterGroup,    ///< what stands before the point in names of parameters
  kParameterOrGroup,  ///< both
};
std::string_view Name(NameSource source);  ///< "", "finger", "object", ...

struct ParamSpec {
  std::string_view name;
  ParamType type = ParamType::kNumber;
  std::string_view sentence;  ///< what it means
  bool required = false;
  std::string_view unit = {};                     ///< "" when dimensionless
  double min = -1e300, max = 1e300;               ///< inclusive, per component; +-1e300 is no limit
  std::span<const std::string_view> values = {};  ///< kEnum: the allowed words
  NameSource names = NameSource::kNone;  ///< kEnum: the allowed words, when they are dynamic
  std::string_view default_text = {};    ///< what leaving it out means; "" when required
};

struct MethodSpec {
  std::string_view name;      ///< on the wire: "job.wait"
  std::string_view words;     ///< on the command line: "job wait"
  std::string_view sentence;  ///< one line of help
  std::span<const ParamSpec> params;
  bool job = false;         ///< answers {"job": n} at once and works on
  std::string_view result;  ///< what the answer holds
};

/// Every method, sorted by name.
std::span<const MethodSpec> MethodTable();

/// Those that start a job of the hand, in the order in which help lists them.
std::span<const MethodSpec> JobMethods();

/// The method with this wire name, or null.
const MethodSpec* FindMethod(std::string_view name);

/// The parameter of this name, or null.
const ParamSpec* FindParam(const MethodSpec& method, std::string_view name);

/// Topics of `subscribe`, sorted.
std::span<const std::string_view> TopicNames();

}  // namespace regrasp
