#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/config/fields/graph.h"

namespace carousel::ringbus {

/// The virtual channels of a graph's links and which of them a packet may take. Channels of a link are shared out to
/// classes, and a packet goes from class to class as the rule says; without a rule there is one class.
struct ChannelPlan {
  ChannelRule rule = ChannelRule::kAny;
  std::uint32_t classes = 1;            ///< that the ways need
  std::vector<std::uint32_t> channels;  ///< by link, one at least
  std::vector<bool> datelines;          ///< by link

  /// The class of a packet of `before` that goes on by `link`. A packet begins with class 0.
  std::uint32_t after(std::uint32_t before, std::uint32_t link) const {
    if (rule == ChannelRule::kAny) return 0;
    return before + (rule == ChannelRule::kHops || datelines[link] ? 1 : 0);
  }
  /// Classes of the link that have channels of their own; where channels are too few, the last one is shared.
  std::uint32_t classes_of(std::uint32_t link) const { return std::min(classes, channels[link]); }
  std::uint32_t class_on(std::uint32_t link, std::uint32_t wanted) const {
    return std::min(wanted, classes_of(link) - 1);
  }
  /// First channel of a packet of the class, and the one behind its last.
  std::pair<std::uint32_t, std::uint32_t> range(std::uint32_t link, std::uint32_t wanted) const {
    const std::uint32_t own = class_on(link, wanted), of = classes_of(link);
    return {own * channels[link] / of, (own + 1) * channels[link] / of};
  }
  bool many() const {
    return std::any_of(channels.begin(), channels.end(), [](std::uint32_t one) { return one > 1; });
  }
};

}  // namespace carousel::ringbus
