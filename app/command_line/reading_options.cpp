#include <fmt/format.h>

#include "app/command_line/command_options.h"
#include "app/command_line/common_options.h"

namespace carousel::app {

void add_inspect(CLI::App& program, InspectArguments& i) {
  CLI::App* inspect = program.add_subcommand("inspect", "List a scene's contents, the effects it needs and their cost");
  inspect->add_option("scene", i.scene, "Scene file (glTF, OBJ, FBX, PLY, ...), or builtin:<name>")
      ->required()
      ->type_name("SCENE");
  add_set_option(*inspect, i.sets);
  inspect
      ->add_option("--frame", i.frame,
                   "Write the camera keys of a configuration that sees this node (default: list the scene)")
      ->type_name("NODE");
  inspect->add_flag("--json", i.json, kJsonHelp);
}

void add_compare(CLI::App& program, CompareArguments& c) {
  CLI::App* compare =
      program.add_subcommand("compare", "Show runs side by side, and what differs in their configurations");
  compare
      ->add_option("runs", c.runs, "Two or more report.json, or their folders; the first is compared with the others")
      ->required()
      ->expected(2, 26)
      ->type_name("PATH");
  compare->add_flag("--all", c.all, "Also list every other value that differs (default: their number)");
  compare
      ->add_option("--only", c.only,
                   "Show only rows, keys and values whose names contain this; * is any text (default: all)")
      ->type_name("PATTERN");
  compare->add_flag("--json", c.json, kJsonHelp);
  compare->add_option("--html", c.html, "Write a page with the comparison as tables and charts (default: none)")
      ->type_name("FILE");
  compare->add_option("--expect", "With `identical`: exit status 1 if the reports differ (default: 0 in any case)")
      ->check(CLI::IsMember({"identical"}))
      ->each([&c](const std::string&) { c.expect_identical = true; });
}

void add_versus(CLI::App& program, VersusArguments& v) {
  CLI::App* versus = program.add_subcommand(
      "versus", "Compare a machine with the conventional one of the same units, memory and rays, and of equal area");
  add_config_options(*versus, v);
  add_charge_all_option(*versus, v);
  versus->add_option("--seeds", v.seeds, "Seeds of the picture with which each machine is simulated")
      ->check(CLI::Range(1, 64))
      ->type_name("N")
      ->capture_default_str();
  versus->add_flag("--no-search", v.no_search,
                   "Do not relax the parts of the slower machine (default: each class of them, one after another)");
  versus
      ->add_option("--out", v.out,
                   "Folder for versus.json, versus.html and config.resolved.yaml (default: out/<config name>-versus)")
      ->type_name("FOLDER");
  versus->add_flag("--force", v.force,
                   "Replace the results of another configuration in the folder (default: an error)");
  versus->add_flag("--json", v.json, kJsonHelp);
  versus->add_flag("--quiet", v.quiet, kQuietHelp);
}

void add_report(CLI::App& program, ReportArguments& r) {
  CLI::App* report =
      program.add_subcommand("report", "Make the HTML page of a run, or of another command's JSON, again");
  report
      ->add_option("folder", r.folder,
                   "Folder that run, sweep, stress, accuracy or versus wrote, or their JSON or that of follow")
      ->required()
      ->type_name("PATH");
  report
      ->add_option("--point", r.point, "Make the page of one point of the sweep in the folder (default: of the sweep)")
      ->type_name("DIGEST");
  report->add_option("--out", r.out, "Page to write (default: beside the JSON, with the ending .html)")
      ->type_name("FILE");
}

void add_serve(CLI::App& program, ServeArguments& s) {
  CLI::App* serve = program.add_subcommand(
      "serve", "Show folders of results as one site on this machine, at 127.0.0.1, until it is interrupted");
  serve
      ->add_option("folders", s.folders, "Folders that run, sweep, stress or accuracy wrote, or that hold such folders")
      ->required()
      ->expected(1, 1000)
      ->type_name("PATH");
  serve->add_option("--port", s.port, "Port to listen at (default: a free one)")
      ->check(CLI::Range(1, 65535))
      ->type_name("PORT");
}

void add_follow(CLI::App& program, FollowArguments& f) {
  CLI::App* follow = program.add_subcommand("follow", "Tell the life of one ray: its waits, packets, tests and hit");
  add_config_options(*follow, f);
  follow->add_option("--pixel", f.pixel, "Pixel, from the left and from the top, both from 0 (default: none)")
      ->type_name("X,Y");
  follow->add_option("--sample", f.sample, "Sample of the pixel")->capture_default_str();
  follow->add_option("--bounce", f.bounce, "Bounce of the path: 0 is the camera ray")->capture_default_str();
  follow->add_flag("--shadow", f.shadow, "The shadow ray of that bounce (default: the ray that seeks a surface)");
  follow->add_option("--ray", f.ray, "Number of the ray in hits.csv, in place of a pixel (default: none)")
      ->type_name("ID");
  follow->add_flag("--json", f.json, kJsonHelp);
  follow->add_flag("--quiet", f.quiet, kQuietHelp);
}

}  // namespace carousel::app
