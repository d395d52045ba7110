#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace carousel::report {

/// The files of our own that are read back.
enum class DocumentKind { kRun, kSweep, kPoint, kStress, kAccuracy, kRayLife, kVersus };

/// A file that the program wrote, as it was read and checked: it keeps its schema (carousel schema report), and its
/// lists fit together, so that readers need not ask. Without its checksum, which is no part of the content.
struct Document {
  DocumentKind kind = DocumentKind::kRun;
  nlohmann::ordered_json json;
};

/// The document with the digest of its content as its last key, `checksum`. How the text is indented does not matter.
nlohmann::ordered_json sealed(nlohmann::ordered_json document);

/// Reads a file of at most 512 MiB. A checksum that is there has to fit; only the point of a sweep needs one. Throws a
/// FileError with the file, the path of the value, what was expected, and what was found.
Document read_document(const std::filesystem::path& file);
/// Reads a document as read_document() does, from a text. `name` stands for the file.
Document parse_document(std::string_view text, const std::string& name);

}  // namespace carousel::report
