#include "core/types/added_names.h"

#include <deque>
#include <map>
#include <mutex>

namespace carousel {

namespace {

std::mutex& added_mutex() {
  static std::mutex one;
  return one;
}

/// By the word of the enum. What was added keeps its address.
std::map<std::string, std::deque<Added>, std::less<>>& all_added() {
  static std::map<std::string, std::deque<Added>, std::less<>> one;
  return one;
}

}  // namespace

std::size_t add_named(std::string_view what, Added added) {
  const std::lock_guard lock(added_mutex());
  std::deque<Added>& of = all_added()[std::string(what)];
  of.push_back(std::move(added));
  return of.size() - 1;
}

const Added* added_at(std::string_view what, std::size_t index) {
  const std::lock_guard lock(added_mutex());
  const auto found = all_added().find(what);
  return found == all_added().end() || index >= found->second.size() ? nullptr : &found->second[index];
}

std::size_t added_in_all() {
  const std::lock_guard lock(added_mutex());
  std::size_t sum = 0;
  for (const auto& [what, added] : all_added()) sum += added.size();
  return sum;
}

std::string_view added_name(std::string_view what, std::size_t index) {
  const Added* const added = added_at(what, index);
  return added == nullptr ? std::string_view{} : added->name;
}

}  // namespace carousel
