#pragma once

#include <string>

namespace carousel::app {

struct ReportArguments {
  std::string folder;  ///< folder that a command wrote, or one of the JSON files in it
  std::string point;   ///< digest of a point of the sweep in the folder; empty: the page of the folder itself
  std::string out;     ///< page to write; empty: beside that file
};

/// `carousel report`: makes a page again from report.json and image.png of a run, or of another command's JSON; those
/// of all results of a folder that run, accuracy and stress share. Returns the exit status.
int report_command(const ReportArguments& arguments);

}  // namespace carousel::app
