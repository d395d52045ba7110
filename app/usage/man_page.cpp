#include "app/usage/man_page.h"

#include <string_view>

#include <fmt/format.h>

#include "app/usage/examples.h"

namespace carousel::app {

namespace {

/// Text as roff takes it: backslashes and dashes are its own characters, and a line that begins with a dot or an
/// apostrophe is a request (groff_man_style(7), "Portability").
std::string roff(std::string_view text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else
      out += c;
    line_begins = c == '\n';
  }
  return out;
}

std::string sentence(const std::string& text) {
  return text.empty() || text.ends_with('.') ? text : text + ".";
}

std::string option_text(const OptionUsage& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "\\fB" : "\\fR, \\fB") + roff(name);
  if (option.argument) names = "\\fI" + roff(option.names.front());
  names += "\\fR";
  if (!option.argument && option.takes != Takes::kNothing) names += " \\fI" + roff(option.value) + "\\fR";
  std::string meaning = sentence(option.meaning);
  if (!option.words.empty()) meaning += fmt::format(" One of {}.", fmt::join(option.words, ", "));
  if (!option.standard.empty()) meaning += fmt::format(" The default is {}.", option.standard);
  return fmt::format(".TP\n{}\n{}\n", names, roff(meaning));
}

std::string examples_of(const CommandUsage& command) {
  std::string out;
  for (const Example& example : command.examples)
    out += fmt::format(".PP\n{}:\n.PP\n.RS 4\n.nf\n{}\n.fi\n.RE\n", roff(example.meaning), roff(example.line));
  return out;
}

std::string command_text(const CommandUsage& command) {
  std::string out = fmt::format(".SS carousel {}\n{}\n", roff(command.name), roff(sentence(command.meaning)));
  for (const OptionUsage& option : command.options) out += option_text(option);
  return out + examples_of(command);
}

std::string key_text(const KeyUsage& key) {
  std::string facts = key.values;
  if (!key.unit.empty()) facts += (facts.empty() ? "" : " ") + key.unit;
  if (!key.standard.empty()) facts += fmt::format("{}default {}", facts.empty() ? "" : "; ", key.standard);
  if (!facts.empty()) facts = " (" + facts + ")";
  return fmt::format(".TP\n\\fB{}\\fR\n{}{}\n", roff(key.path), roff(key.meaning), roff(facts));
}

}  // namespace

std::string man_page(const ProgramUsage& program, const std::vector<KeyUsage>& keys, const std::string& version) {
  std::string out = fmt::format(
      ".\\\" Made by carousel man.\n.TH CAROUSEL 1 \"\" \"Carousel {}\" \"User Commands\"\n"
      ".SH NAME\ncarousel \\- simulate ray\\-tracing hardware in which shapes travel\n"
      ".SH SYNOPSIS\n\\fBcarousel\\fR \\fICOMMAND\\fR [\\fIOPTION\\fR ...]\n"
      ".SH DESCRIPTION\n{}\nA configuration, a file in YAML or JSON, describes a scene and a machine. The native "
      "engine "
      "runs the machine on worker threads and real queues; the cycle engine simulates it under virtual time and says "
      "how many cycles it took and which parts limit it.\n",
      roff(version), roff(program.meaning));
  for (const OptionUsage& option : program.options) out += option_text(option);
  out += ".SH COMMANDS\n";
  for (const CommandUsage& command : program.commands) out += command_text(command);
  out +=
      ".SH CONFIGURATION\nEvery key may stand in a configuration file, and behind \\fB\\-\\-set\\fR and "
      "\\fB\\-\\-vary\\fR with dots between the names of its sections. Only \\fBscene\\fR has to be given.\n";
  for (const KeyUsage& key : keys) out += key_text(key);
  out += ".SH EXIT STATUS\n";
  for (const StatusMeaning& status : exit_statuses())
    out += fmt::format(".TP\n\\fB{}\\fR\n{}\n", status.status, roff(status.meaning));
  out +=
      ".SH ENVIRONMENT\n.TP\n\\fBCOLUMNS\\fR\nThe width of tables on a terminal.\n"
      ".TP\n\\fBCAROUSEL\\fR\nThe program that the Python package runs, if it is not the one on the PATH.\n"
      ".SH FILES\n.TP\n\\fIshare/carousel/configs\\fR\nConfigurations to begin with, and the schema by which editors "
      "complete and check them.\n"
      ".TP\n\\fIshare/doc/carousel\\fR\nThe tutorial, the description of every number of a report, and the models.\n"
      ".SH SEE ALSO\nThe tutorial, \\fIshare/doc/carousel/guides/tutorial.md\\fR.\n";
  return out;
}

}  // namespace carousel::app
