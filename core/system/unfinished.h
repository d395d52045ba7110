#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace carousel {

/// Names and remains of unfinished files and folders. Such a name is `.<target>.carousel-<host>.<process>.<number>`,
/// and that of a file ends in `.partial`. Its maker holds a lock (flock) on it where the file system has locks.

inline constexpr std::string_view kUnfinishedFile = ".partial";

/// A new name beside `target`; `end` is kUnfinishedFile or empty. No other call returns it, in any process of any host.
std::filesystem::path unfinished_name(const std::filesystem::path& target, std::string_view end);

/// True for an unfinished file or folder whose maker is dead. One of this host is if nobody has it locked, or, on a
/// file system without locks, if no process has its maker's number. The maker of another host's file cannot be looked
/// for: it is taken for dead when nothing about the file has changed for thirty days.
bool is_abandoned(const std::filesystem::path& unfinished);

/// Removes the abandoned files and folders that were to become `target`.
void remove_abandoned_of(const std::filesystem::path& target);

/// Removes the abandoned files in `folder`, whatever they were to become. Waits up to a second for makers that still
/// hold theirs, since a killed process does not end at once.
void remove_abandoned(const std::filesystem::path& folder);

}  // namespace carousel
