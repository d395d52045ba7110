#include <fmt/format.h>

#include "app/usage/completion.h"

namespace carousel::app {

namespace {

// Bash breaks a word at = and :, and replaces only the part behind the last of them: `cut` is the part before it.
constexpr const char* kBashFunctions = R"BASH(
# _carousel_offer BEFORE WORD CANDIDATE...: offers the candidates that begin with WORD; BEFORE is what stands before it
# in the word that is completed.
_carousel_offer() {
  local before=$1 word=$2 candidate cut='' whole=$1$2
  shift 2
  [[ $COMP_WORDBREAKS == *=* && $whole =~ ^.*= ]] && cut=${BASH_REMATCH[0]}
  [[ $COMP_WORDBREAKS == *:* && $whole =~ ^.*: && ${#BASH_REMATCH[0]} -gt ${#cut} ]] && cut=${BASH_REMATCH[0]}
  for candidate; do
    [[ $candidate == "$word"* ]] || continue
    candidate=$before$candidate
    COMPREPLY+=("${candidate#"$cut"}")
    [[ $candidate == *= ]] && compopt -o nospace 2>/dev/null
  done
}

# _carousel_key BEFORE WORD MANY: a key, or behind its = a value; MANY: one of several values, separated by commas.
_carousel_key() {
  local before=$1 word=$2 key
  if [[ $word != *=* ]]; then
    _carousel_offer "$before" "$word" $_carousel_keys
    return
  fi
  key=${word%%=*}
  before=$before$key=
  word=${word#*=}
  if [[ $3 == many && $word == *,* ]]; then
    before=$before${word%,*},
    word=${word##*,}
  fi
  _carousel_offer "$before" "$word" $(_carousel_values "$key")
}

_carousel() {
  local line=${COMP_LINE:0:COMP_POINT} words word option='' before='' command=''
  COMPREPLY=()
  read -ra words <<<"$line"
  [[ $line == *[[:space:]] ]] && words+=('')
  word=${words[${#words[@]} - 1]}
  if ((${#words[@]} > 2)); then
    command=${words[1]}
    option=${words[${#words[@]} - 2]}
  fi
  if [[ $word == --*=* ]]; then
    option=${word%%=*}
    before=$option=
    word=${word#*=}
  elif [[ $word == -* ]]; then
    option=''
  fi
)BASH";

std::string bash_words(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

/// The command that offers what an option takes, as a line of the script. Nothing offered means names of files.
std::string offer(const OptionUsage& option, const std::string& scenes) {
  switch (option.takes) {
    case Takes::kWords:
      if (option.list)
        return fmt::format(
            "[[ $word == *,* ]] && before=$before${{word%,*}}, word=${{word##*,}}; "
            "_carousel_offer \"$before\" \"$word\" {}",
            bash_words(option.words));
      return fmt::format("_carousel_offer \"$before\" \"$word\" {}", bash_words(option.words));
    case Takes::kScene:
      return fmt::format("_carousel_offer \"$before\" \"$word\" {}", scenes);
    case Takes::kKeyAndValue:
      return "_carousel_key \"$before\" \"$word\" one";
    case Takes::kKeyAndValues:
      return "_carousel_key \"$before\" \"$word\" many";
    case Takes::kFolder:
      return "compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- \"$word\")";
    case Takes::kNothing:
    case Takes::kText:
    case Takes::kFile:
      return ":";
  }
  return ":";
}

}  // namespace

std::string bash_completion(const ProgramUsage& program, const std::vector<KeyUsage>& keys) {
  std::string out = "# Completion of carousel for bash, made by carousel completion bash.\n\n_carousel_keys='";
  for (const KeyUsage& key : keys) out += key.path + "=\n";
  out += "'\n\n# The words that a configuration key may be.\n_carousel_values() {\n  case $1 in\n";
  std::string scenes;
  for (const KeyUsage& key : keys) {
    if (!key.words.empty()) out += fmt::format("    {}) echo {} ;;\n", key.path, bash_words(key.words));
    if (key.path == "scene.builtin")
      for (const std::string& word : key.words) scenes += (scenes.empty() ? "builtin:" : " builtin:") + word;
  }
  out += "  esac\n}\n";
  out += kBashFunctions;
  out += "  case $command:$option in\n";
  std::vector<std::string> first;
  for (const OptionUsage& option : program.options) first.insert(first.end(), option.names.begin(), option.names.end());
  std::string arguments = fmt::format("    *) ;;\n  esac\n  case $command in\n");
  for (const CommandUsage& command : program.commands) {
    first.push_back(command.name);
    std::vector<std::string> names;
    std::string argument = ":";
    for (const OptionUsage& option : command.options) {
      if (option.argument) argument = offer(option, scenes);
      if (option.argument) continue;
      names.insert(names.end(), option.names.begin(), option.names.end());
      if (option.takes != Takes::kNothing)
        out += fmt::format("    {}:{}) {}; return ;;\n", command.name, option.names.back(), offer(option, scenes));
    }
    arguments += fmt::format(
        "    {})\n      if [[ $word == -* ]]; then _carousel_offer '' \"$word\" {}\n      else {}\n"
        "      fi ;;\n",
        command.name, bash_words(names), argument);
  }
  out += arguments + fmt::format("    '') _carousel_offer '' \"$word\" {} ;;\n  esac\n}}\n\n", bash_words(first));
  return out + "complete -o default -F _carousel carousel\n";
}

}  // namespace carousel::app
