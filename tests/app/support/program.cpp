#include "tests/app/support/program.h"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace carousel {

Program::Program() {
  std::string name = (std::filesystem::temp_directory_path() / "carousel_app_XXXXXX").string();
  folder_ = mkdtemp(name.data());
}

Program::~Program() {
  std::filesystem::remove_all(folder_);
}

void Program::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name, std::ios::binary) << text;
}

std::string Program::read(const std::string& name) const {
  std::ifstream in(folder_ / name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

pid_t Program::start(const std::vector<std::string>& arguments, bool own_group) const {
  std::vector<std::string> words{CAROUSEL_BINARY};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t pid = fork();
  if (pid != 0) {
    if (own_group) setpgid(pid, pid);  // here too, as it may not have come so far when this function returns
    return pid;
  }
  if (own_group) setpgid(0, 0);  // and here, as the parent may not do so any more after exec
  if (chdir(folder_.c_str()) != 0) _exit(127);
  for (const auto& [name, descriptor] : {std::pair{"stdout.txt", 1}, std::pair{"stderr.txt", 2}}) {
    const int file = open(name, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file < 0 || dup2(file, descriptor) < 0) _exit(127);
  }
  execv(argv[0], argv.data());
  _exit(127);
}

Outcome Program::wait(pid_t pid) const {
  int status = 0;
  waitpid(pid, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read("stdout.txt"), read("stderr.txt")};
}

Outcome Program::run(const std::vector<std::string>& arguments) const {
  return wait(start(arguments));
}

}  // namespace carousel
