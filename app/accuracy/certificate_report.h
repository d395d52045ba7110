#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "app/accuracy/case_text.h"
#include "app/accuracy/certificate.h"

namespace carousel::app {

/// A row for each property and level, then a reproducer of each broken promise.
std::string certificate_table(const Certificate& certificate);
/// The certificate as JSON, with a reproducer also of violations that are only counted.
nlohmann::json certificate_json(const Certificate& certificate);

/// A case that is tested again.
struct Replay {
  explicit Replay(const CertificateCase& one);

  const CertificateCase& tried;  ///< must outlive this
  accel::Judgement judgement;
  accel::CaseStory story;
};

std::string replay_text(const Replay& replay);
nlohmann::json replay_json(const Replay& replay);

}  // namespace carousel::app
