#include <string_view>

#include <fmt/format.h>

#include "app/usage/completion.h"

namespace carousel::app {

namespace {

constexpr const char* kZshFunctions = R"ZSH(
# A key, or behind its = a value: of several, separated by commas, where the first argument is `many`.
_carousel_key() {
  local key
  if compset -P '(#b)([^=]#)='; then
    key=$match[1]
    [[ $1 == many ]] && compset -P '*,'
    compadd -- ${(s: :)_carousel_words[$key]}
  else
    compadd -S = -- $_carousel_keys
  fi
}
)ZSH";

/// Text within a pair of apostrophes, and as _arguments takes it: brackets and colons are its own.
std::string zsh_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'')
      out += "'\\''";
    else if (c == '[' || c == ']' || c == ':' || c == '\\')
      out += fmt::format("\\{}", c);
    else
      out += c;
  }
  return out;
}

std::string zsh_words(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

std::string action(const OptionUsage& option, const std::string& scenes) {
  switch (option.takes) {
    case Takes::kWords:
      return option.list ? fmt::format("_values -s , {} {}", zsh_text(option.value), zsh_words(option.words))
                         : fmt::format("({})", zsh_words(option.words));
    case Takes::kScene:
      return fmt::format("_alternative \"scenes:scene:({})\" \"files:file:_files\"", scenes);
    case Takes::kKeyAndValue:
      return "_carousel_key one";
    case Takes::kKeyAndValues:
      return "_carousel_key many";
    case Takes::kFolder:
      return "_files -/";
    case Takes::kFile:
      return "_files";
    case Takes::kNothing:
    case Takes::kText:
      return " ";
  }
  return " ";
}

std::string specification(const OptionUsage& option, const std::string& scenes) {
  const std::string meaning = zsh_text(option.meaning);
  if (option.argument)
    return fmt::format(" \\\n        '{}:{}:{}'", option.repeated ? "*" : "", zsh_text(option.names.front()),
                       action(option, scenes));
  std::string out;
  for (const std::string& name : option.names) {
    const bool value = option.takes != Takes::kNothing;
    out += fmt::format(" \\\n        '{}{}{}[{}]{}'", option.repeated ? "*" : "", name, value ? "=" : "", meaning,
                       value ? fmt::format(":{}:{}", zsh_text(option.value), action(option, scenes)) : "");
  }
  return out;
}

}  // namespace

std::string zsh_completion(const ProgramUsage& program, const std::vector<KeyUsage>& keys) {
  std::string out = "#compdef carousel\n# Completion of carousel for zsh, made by carousel completion zsh.\n\n";
  out += "_carousel_keys=(\n";
  for (const KeyUsage& key : keys) out += "  " + key.path + "\n";
  out += ")\n# The words that a key may be.\ntypeset -gA _carousel_words=(\n";
  std::string scenes;
  for (const KeyUsage& key : keys) {
    if (!key.words.empty()) out += fmt::format("  {} '{}'\n", key.path, zsh_words(key.words));
    if (key.path == "scene.builtin")
      for (const std::string& word : key.words) scenes += (scenes.empty() ? "builtin\\:" : " builtin\\:") + word;
  }
  out += fmt::format(")\n{}\n_carousel() {{\n  setopt local_options extended_glob\n  local -a commands=(\n",
                     kZshFunctions);
  for (const CommandUsage& command : program.commands)
    out += fmt::format("    '{}:{}'\n", command.name, zsh_text(command.meaning));
  out +=
      "  )\n  if ((CURRENT == 2)) && [[ $PREFIX != -* ]]; then\n    _describe command commands\n    return\n  fi\n"
      "  local command=$words[2]\n  ((CURRENT > 2)) && shift words && ((CURRENT--))\n  case $command in\n";
  for (const CommandUsage& command : program.commands) {
    out += fmt::format("    {})\n      _arguments", command.name);
    for (const OptionUsage& option : command.options) out += specification(option, scenes);
    out += " ;;\n";
  }
  out += "    *)\n      _arguments";
  for (const OptionUsage& option : program.options) out += specification(option, scenes);
  return out + " ;;\n  esac\n}\n\n_carousel \"$@\"\n";
}

}  // namespace carousel::app
