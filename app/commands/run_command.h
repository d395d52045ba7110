#pragma once

#include <string>

#include "app/run/prepare.h"
#include "app/trace/trace_file.h"

namespace carousel::app {

struct RunArguments : ConfigArguments {
  std::string out;          ///< folder; empty: out/<name of the configuration>
  std::string dump_rays;    ///< ray CSV to write; empty: none
  std::string dump_trees;   ///< file of trees to write; empty: none
  std::string heat;         ///< scale of the maps of the pixels' cost, linear or log; empty: none are written
  std::string dump_memory;  ///< CSV of memory requests to write; empty: none
  TraceArguments trace;
  bool hits = false, json = false, quiet = false, force = false, no_html = false;
  bool audit = false;  ///< with sampling.fraction: the whole frame is simulated, too
};

/// `carousel run`: one simulation. Returns the exit status.
int run_command(const RunArguments& arguments);

}  // namespace carousel::app
