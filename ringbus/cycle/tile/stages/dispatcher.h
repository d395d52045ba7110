#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "core/types/dispatch_rule.h"
#include "ringbus/cycle/fabric/course.h"
#include "ringbus/cycle/tile/stages/issue_queue.h"
#include "ringbus/cycle/tile/stages/ray_entry.h"

namespace carousel::ringbus::cycle {

/// The decisions of the dispatch stage: which packet it takes up next, of those that have arrived, of new rays that
/// travel, and of the issue queue; and what becomes of it.
///
/// Packets of other resources go first. With `visit: owners` packets without a ray here pass beside it. A packet with
/// rays here is taken only when a test context and a place in its egress queue are free, so that tests always end; a
/// packet without rays here goes on meanwhile (an idle visit).
///
/// With `testers.window` it chooses among the first packets of an input queue (US 9633468 lets a resource look at
/// several packets of its queue and process them out of order where that helps). It takes the first one that can go on
/// at once and needs no shapes from memory, otherwise the first one that can go on. It looks at all of them at the same
/// time, as does a plugin's rule in its place; dispatch needs a cycle more if it takes another than the first. So that
/// none waits for ever, the first one is passed over at most as often as the window is long.
class Dispatcher {
 public:
  /// Keeps the references. `in`: its input queues, by port.
  Dispatcher(const TileParts& parts, const TileSettings& settings, std::vector<InPort>& in, TestContexts& contexts,
             IssueQueue& issue, RayEntry& entry, const ShadeHelp& help);

  /// Takes up one packet, if it is free and can. Returns whether it did.
  bool handle(Cycle now);
  /// Lets packets without a ray here pass. `dispatch_rests`: dispatch takes up nothing in this event, and what can
  /// leave at once goes past the egress queue. Returns whether any passed.
  bool cut_through(Cycle now, bool dispatch_rests = false);
  bool cuts_through() const { return cuts_through_; }
  bool has_window() const { return window_ > 1; }

  /// Tells whether a packet goes by without a look into it; only where such packets cut through.
  bool passes_by(const Token& token) const { return routed_ ? token.stop != id().value : token.skip > 0; }
  /// The port by which such a packet leaves that has come in by port `d`.
  OutPort& way_of(std::size_t d, const Token& token) {
    return parts_.egress.port(routed_ ? parts_.machine.topology.exit(id(), ResourceId(token.stop), token.lane).port
                                      : d);
  }
  /// Prepares such a packet for its next link. Returns whether the next node sends it on when its head has come.
  bool pass_by(Token& token) const {
    if (routed_) [[unlikely]]
      return course_of(token, parts_.machine.topology, id()).through;
    --token.skip;
    return token.skip > 0;
  }

  /// The first packet of a queue needs dispatch, or may be brought there.
  bool stops_here(const InPort& in) const { return has_window() || !cuts_through_ || !passes_by(in.front()); }
  /// Something waits for dispatch at `now`, or could have gone if it had been free.
  bool is_wanted(Cycle now) const {
    if (entry_.waiting() || issue_.front_is_ready()) return true;
    for (const InPort& in : in_)
      if (in.next() <= now && stops_here(in)) return true;
    return false;
  }
  /// The time after `now` at which a packet comes in. One that is not later than the last step was dealt with in it, or
  /// waits for another event.
  Cycle next_arrival_after(Cycle now) const {
    Cycle first = kNever;
    for (const InPort& in : in_)
      if (const Cycle at = has_window() ? in.next_after(now) : in.next(); at > now && at < first) first = at;
    return first;
  }
  /// No packet that has arrived waits.
  bool links_rest(Cycle now) const {
    for (const InPort& in : in_)
      if (in.next() <= now) return false;
    return true;
  }

 private:
  /// The ways in which dispatch deals with a packet that has arrived.
  enum class Action : std::uint8_t {
    kPassOn,      ///< it has no rays here, and is looked through
    kHear,        ///< it is heard, and its owner does not wait for this resource
    kTakeAnswer,  ///< another resource has answered a packet of this one
    kTestOwn,     ///< it is back, and its owner's rays are tested now
    kRetire,
    kDiscard,
    kRetireRays,  ///< it is back from its way with new rays
    kTakeRays,    ///< its new rays may take slots here
    kForward,     ///< it goes on untouched, as a resource has stopped
    kTest,
    kVisit,  ///< it has no tests here
    kJoin,   ///< its memberships join collections here
  };
  /// The one place that says what becomes of a packet, and what that takes.
  struct Decision {
    Action action = Action::kVisit;
    OutPort* place = nullptr;    ///< it needs a place in this egress queue; null: none
    bool needs_context = false;  ///< it needs a free test context
  };
  /// Absent: packets without rays here do not pass through dispatch.
  std::optional<Decision> decide(std::size_t d, const Token& token);
  bool may_take(const Decision& decision) {
    if (decision.place != nullptr && !parts_.egress.has_place(*decision.place)) return false;
    return !decision.needs_context || context_is_free();
  }
  bool context_is_free() const { return !help_.holds() && contexts_.has_free(); }

  bool handle_arrival(std::size_t d, Cycle now);
  void take(const Decision& decision, std::size_t d, Cycle now);
  void take_answer(const Decision& decision, const Token& token, Cycle now);
  void test(PacketId id, std::size_t entries, Cycle now);
  void visit(Action action, PacketId id, Cycle now);
  bool handle_issue(Cycle now);

  bool choose_to_cut(std::size_t d, Cycle now);
  bool choose_to_handle(std::size_t d, Cycle now);
  std::size_t seen(std::size_t d, Cycle now) const;
  std::size_t ask_rule(std::size_t d, std::size_t end);
  bool waits_for_shapes(const Decision& decision, const Token& token) const;

  ResourceId id() const { return parts_.resource.id(); }

  TileParts parts_;
  std::vector<InPort>& in_;
  TestContexts& contexts_;
  IssueQueue& issue_;
  RayEntry& entry_;
  const ShadeHelp& help_;
  bool visit_all_, routed_, cuts_through_, broadcasts_, fetch_by_resource_;
  const DispatchRule* rule_;              // a plugin's; null: one of the program
  std::string_view rule_name_;            // which stays where it is
  std::vector<WaitingPacket> waiting_;    // scratch
  std::size_t window_;                    // packets at the front of an input queue among which it chooses
  std::size_t next_in_ = 0;               // ports have their turns
  std::vector<std::size_t> passed_over_;  // by port: how often the first one has been
};

}  // namespace carousel::ringbus::cycle
