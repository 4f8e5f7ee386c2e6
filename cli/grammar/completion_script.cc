// The scripts that bash, zsh and fish load. They ask `regrasp __complete`, which takes milliseconds
// and waits for a daemon at most 150 ms.

#include "cli/help/help.h"

namespace regrasp::cli {
namespace {

constexpr const char* kBash = R"(# bash completion for regrasp
_regrasp() {
  local line
  COMPREPLY=()
  while IFS= read -r line; do
    if [[ $line == :files ]]; then
      compopt -o filenames 2>/dev/null
      while IFS= read -r line; do COMPREPLY+=("$line"); done \
        < <(compgen -f -- "${COMP_WORDS[COMP_CWORD]}")
    else
      COMPREPLY+=("${line%%$'\t'*}")
    fi
  done < <("${COMP_WORDS[0]}" __complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
}
complete -F _regrasp regrasp
)";

constexpr const char* kZsh = R"(#compdef regrasp
_regrasp() {
  local -a items
  local line files=
  for line in "${(@f)$($words[1] __complete "${(@)words[2,CURRENT]}" 2>/dev/null)}"; do
    if [[ $line == :files ]]; then
      files=yes
    elif [[ -n $line ]]; then
      items+=("${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}")
    fi
  done
  (( ${#items} )) && _describe -V regrasp items
  [[ -z $files ]] || _files
}
if [[ $funcstack[1] == _regrasp ]]; then
  _regrasp "$@"
else
  compdef _regrasp regrasp
fi
)";

constexpr const char* kFish = R"(# fish completion for regrasp
function __regrasp_complete
  set -l words (commandline -opc)
  set -l current (commandline -ct)
  for line in ($words[1] __complete $words[2..] "$current" 2>/dev/null)
    if test "$line" = :files
      __fish_complete_path "$current"
    else
      echo $line
    end
  end
end
complete -c regrasp -f -k -a '(__regrasp_complete)'
)";

}  // namespace

std::string CompletionScript(const std::string& shell) {
  return shell == "fish" ? kFish : shell == "zsh" ? kZsh : kBash;
}

}  // namespace regrasp::cli
