#pragma once

#include <string>
#include <vector>

namespace carousel::app {

struct SchemaArguments {
  std::string file;                  ///< config | report
  std::vector<std::string> plugins;  ///< files; their names are values of keys
  std::string graph;                 ///< the path of a configuration whose graph has the names; empty: any names
  bool markdown = false;             ///< every key or number as Markdown, instead of JSON Schema
};

/// `carousel schema`. Returns the exit status.
int schema_command(const SchemaArguments& arguments);

}  // namespace carousel::app
