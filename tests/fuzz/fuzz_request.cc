// What a client sends, down to checked parameters: must never crash, hang or accept what the rules
// refuse.
//   cmake --preset fuzz && ninja -C build/fuzz fuzz_request && build/fuzz/tests/fuzz_request
//   -max_len=70000

#include <cstdint>
#include <cstdlib>

#include "core/protocol/methods.h"
#include "daemon/requests/params.h"
#include "daemon/wire/rpc.h"

namespace {

using namespace regrasp;

void Require(bool condition) {
  if (!condition) std::abort();
}

void CheckParams(const RpcRequest& request) {
  const MethodSpec* method = FindMethod(request.method);
  if (!method) return;
  const NameLookup names = [](NameSource) {
    return std::vector<std::string>{"ring", "sphere", "gravity"};
  };
  try {
    const Params params(*method, request.params, names);
    for (const ParamSpec& spec : method->params) {
      if (!params.Has(spec.name)) {
        Require(!spec.required);
      } else if (spec.type == ParamType::kNumber || spec.type == ParamType::kInteger) {
        const double value = params.Number(spec.name, 0);
        Require(value >= spec.min && value <= spec.max);
      }
    }
  } catch (const RpcException& e) {
    Require(Json::accept(ToLine(ErrorMessage(request.id, e.error()))));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const RpcLine line = ParseLine({reinterpret_cast<const char*>(data), size});
  Require(line.requests.size() <= kMaxBatch);
  for (const RpcRequest& request : line.requests) {
    if (request.error)
      Require(Json::accept(ToLine(ErrorMessage(request.id, *request.error))));
    else
      CheckParams(request);
  }
  return 0;
}
