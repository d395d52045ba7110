#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace carousel::app {

/// The text that an option or an argument takes, for completion.
enum class Takes { kNothing, kText, kWords, kFile, kFolder, kScene, kKeyAndValue, kKeyAndValues };

/// An option of a command, or an argument without a name.
struct OptionUsage {
  std::vector<std::string> names;  ///< with dashes; of an argument its name alone
  bool argument = false;           ///< it has no dashes
  bool repeated = false;           ///< may stand several times
  bool list = false;               ///< its value may be several, separated by commas
  Takes takes = Takes::kNothing;
  std::string value;               ///< type of the value as the help shows it: FILE, UINT
  std::vector<std::string> words;  ///< with Takes::kWords: all that it may be
  std::string meaning, standard;   ///< `standard`: the default, if the meaning does not name it
};

/// A command line that shows the use of a command.
struct Example {
  std::string command, line, meaning;
};

struct CommandUsage {
  std::string name, meaning;
  std::vector<OptionUsage> options;
  std::vector<Example> examples;
};

/// All that the program takes, from the table of its options: the source of man page and completions.
struct ProgramUsage {
  std::string name, meaning;
  std::vector<OptionUsage> options;
  std::vector<CommandUsage> commands;
};

ProgramUsage usage_of(const CLI::App& program);

/// A configuration key that is more than a section, with the words that it may be (empty: numbers or text).
struct KeyUsage {
  std::string path;
  std::vector<std::string> words;
  std::string values, standard, unit, meaning;  ///< `values`: words or range
};

/// Every such key, from the schema of configurations and in its order.
std::vector<KeyUsage> key_usages();

}  // namespace carousel::app
