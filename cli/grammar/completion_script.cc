// The scripts that bash, zsh and fish load. They ask `regrasp __complete`, which takes milliseconds
// and waits for a daemon at most 150 ms.

#include "cli/help/help.h"

namespace regrasp::cli {
namespace {

constexpr const char* kBash = R"(# bash completion for regrasp
_regrasp() {
  local line current=${COMP_WORDS[COMP_CWORD]}
  COMPREPLY=()
  while IFS= read -r line; do
    if [[ $line == :files* ]]; then
      compopt -o filenames 2>/dev/null
      # A name that begins with - would be an option.
      while IFS= read -r line; do
        [[ $line == -* ]] && line=./$line
        COMPREPLY+=("$line")
      done < <(compgen -f -X "!*${line#:files}" -- "$current"; compgen -d -- "$current")
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
  local line files= glob
  for line in "${(@f)$($words[1] __complete "${(@)words[2,CURRENT]}" 2>/dev/null)}"; do
    if [[ $line == :files* ]]; then
      files=yes
      glob="*${line#:files}"
    elif [[ -n $line ]]; then
      items+=("${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}")
    fi
  done
  (( ${#items} )) && _describe -V regrasp items
  [[ -n $files ]] || return 0
  # A name that begins with - would be an option.
  local -a dashed
  [[ $PREFIX == */* ]] || dashed=(./-${~glob}(N))
  (( ${#dashed} )) && compadd -a dashed
  _files -g "$glob"
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
    if string match -q -- ':files*' "$line"
      set -l suffix (string escape --style=regex -- (string sub -s 7 -- "$line"))
      # A name that begins with - would be an option.
      set -l place "$current"
      set -l added '^$'
      if not string match -q -- '*/*' "$current"
        set place "./$current"
        set added '^\./(?!-)'
      end
      __fish_complete_path "$place" | string match -r -- '^[^\t]*(?:/|'"$suffix"')(?:\t.*)?$' |
        string replace -r -- "$added" ''
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
