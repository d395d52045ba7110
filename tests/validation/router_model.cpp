// A network of input-queued routers in virtual time, without code of the simulator: the rules of BookSim2's router as
// docs/internals/validation.md lists them, every cycle of every router in turn. tests/validation/graph_rows.py runs it
// with several seeds.
//
//   router_model OFFERED FLITS CHANNELS PLACES SPECULATIVE SEED < GRAPH
//
// GRAPH has the numbers of nodes and of routers without one, and lines FROM TO LATENCY, a way each. Packets are
// uniform; 15,000 cycles of warm-up are followed by as many that are measured. Prints the flits accepted a node and
// cycle.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <iostream>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace {

using Index = std::size_t;
constexpr Index kNone = ~Index{0};
constexpr std::int64_t kWindow = 15'000;

struct Flit {
  Index to = 0;
  bool head = false, tail = false;
  Index channel = kNone;
};

/// Things that come after a time.
template <class T>
class Delay {
 public:
  void put(std::int64_t at, T what) { all_.emplace_back(at, std::move(what)); }
  template <class Use>
  void take(std::int64_t now, const Use& use) {
    for (; !all_.empty() && all_.front().first <= now; all_.pop_front()) use(all_.front().second);
  }

 private:
  std::deque<std::pair<std::int64_t, T>> all_;
};

/// iSLIP of one iteration (N. McKeown, IEEE/ACM Trans. Networking 7 (1999)).
class Allocator {
 public:
  Allocator(Index inputs, Index outputs)
      : next_input_(outputs), next_output_(inputs), asked_(outputs), granted_(inputs), match_(inputs, kNone) {}

  void clear() {
    for (std::vector<Index>& one : asked_) one.clear();
    match_.assign(match_.size(), kNone);
  }
  void ask(Index input, Index output) { asked_[output].push_back(input); }
  void run() {
    for (std::vector<Index>& one : granted_) one.clear();
    for (Index output = 0; output < asked_.size(); ++output)
      if (!asked_[output].empty())
        granted_[first(asked_[output], next_input_[output], match_.size())].push_back(output);
    for (Index input = 0; input < match_.size(); ++input) {
      if (granted_[input].empty()) continue;
      const Index output = first(granted_[input], next_output_[input], asked_.size());
      match_[input] = output;
      next_input_[output] = (input + 1) % match_.size();
      next_output_[input] = (output + 1) % asked_.size();
    }
  }
  Index match(Index input) const { return match_[input]; }

 private:
  /// The one of `among` that comes first from `from` on.
  static Index first(const std::vector<Index>& among, Index from, Index many) {
    Index best = among.front();
    for (const Index one : among)
      if ((one + many - from) % many < (best + many - from) % many) best = one;
    return best;
  }

  std::vector<Index> next_input_, next_output_;
  std::vector<std::vector<Index>> asked_, granted_;
  std::vector<Index> match_;
};

/// A way from router to router, or between a router and its node.
struct Link {
  Index from = 0, to = 0;
  std::int64_t latency = 1;
  Delay<Flit> flits;
  Delay<Index> credits;  // channels
};

enum class State { kIdle, kClaims, kGotChannel, kHasChannel };

struct Queue {
  std::deque<Flit> flits;
  State state = State::kIdle;
  Index output = kNone, channel = kNone;
};

struct Rules {
  double offered;
  int flits;
  Index channels, places;
  bool speculative;
};

class Router {
 public:
  Router(const Rules& rules, std::vector<Link*> in, std::vector<Link*> out)
      : rules_(rules),
        in_(std::move(in)),
        out_(std::move(out)),
        queues_(in_.size(), std::vector<Queue>(rules.channels)),
        owned_(out_.size(), std::vector<bool>(rules.channels)),
        used_(out_.size(), std::vector<Index>(rules.channels)),
        claims_(in_.size() * rules.channels, out_.size() * rules.channels),
        switch_(in_.size(), out_.size()),
        turn_(in_.size()),
        asking_(in_.size(), std::vector<Index>(out_.size())) {}

  /// `exits`: by destination the way out.
  void step(std::int64_t now, const std::vector<Index>& exits) {
    for (Index i = 0; i < in_.size(); ++i)
      in_[i]->flits.take(now, [&](const Flit& flit) {
        Queue& queue = queues_[i][flit.channel];
        queue.flits.push_back(flit);
        if (queue.state == State::kIdle) queue.state = State::kClaims;
      });
    for (Index o = 0; o < out_.size(); ++o) out_[o]->credits.take(now, [&](Index channel) { --used_[o][channel]; });
    claims_.clear();
    switch_.clear();
    for (Index i = 0; i < in_.size(); ++i) {
      asking_[i].assign(out_.size(), kNone);
      for (Index c = 0; c < rules_.channels; ++c)
        if (!queues_[i][c].flits.empty()) ask(i, c, exits[queues_[i][c].flits.front().to]);
      for (Index o = 0; o < out_.size(); ++o)
        if (asking_[i][o] != kNone) switch_.ask(i, o);
    }
    claims_.run();
    switch_.run();
    for (Index i = 0; i < in_.size(); ++i)
      for (Index c = 0; c < rules_.channels; ++c) take_channel(queues_[i][c], claims_.match(i * rules_.channels + c));
    for (Index i = 0; i < in_.size(); ++i)
      if (const Index o = switch_.match(i); o != kNone) move(now, i, asking_[i][o]);
    for (std::vector<Queue>& all : queues_)
      for (Queue& queue : all)
        if (queue.state == State::kGotChannel) queue.state = State::kHasChannel;
  }

 private:
  bool has_place(Index output, Index channel) const { return used_[output][channel] < rules_.places; }

  void ask(Index input, Index c, Index output) {
    Queue& queue = queues_[input][c];
    const bool claims = queue.state == State::kClaims;
    bool may_leave = !claims && has_place(queue.output, queue.channel);
    for (Index channel = 0; claims && channel < rules_.channels; ++channel) {
      if (owned_[output][channel]) continue;
      claims_.ask(input * rules_.channels + c, output * rules_.channels + channel);
      may_leave |= rules_.speculative && has_place(output, channel);
    }
    if (!may_leave) return;
    Index& asking = asking_[input][output];
    const auto worth = [&](Index one) {
      const bool guess = queues_[input][one].state == State::kClaims;
      return std::pair(guess, (one + rules_.channels - turn_[input]) % rules_.channels);
    };
    if (asking == kNone || worth(c) < worth(asking)) asking = c;
  }

  void take_channel(Queue& queue, Index match) {
    if (queue.state != State::kClaims || match == kNone) return;
    queue.output = match / rules_.channels;
    queue.channel = match % rules_.channels;
    owned_[queue.output][queue.channel] = true;
    queue.state = State::kGotChannel;
  }

  void move(std::int64_t now, Index input, Index c) {
    Queue& queue = queues_[input][c];
    turn_[input] = (c + 1) % rules_.channels;
    if (queue.state == State::kClaims) return;  // guessed, and got no channel
    if (queue.state == State::kGotChannel && !has_place(queue.output, queue.channel)) return;
    Flit flit = queue.flits.front();
    queue.flits.pop_front();
    flit.channel = queue.channel;
    ++used_[queue.output][queue.channel];
    out_[queue.output]->flits.put(now + out_[queue.output]->latency + 2, flit);
    in_[input]->credits.put(now + in_[input]->latency + 1, c);
    queue.state = State::kHasChannel;
    if (!flit.tail) return;
    owned_[queue.output][queue.channel] = false;
    queue.state = queue.flits.empty() ? State::kIdle : State::kClaims;
  }

  const Rules& rules_;
  std::vector<Link*> in_, out_;
  std::vector<std::vector<Queue>> queues_;  // by way in and channel
  std::vector<std::vector<bool>> owned_;    // by way out and channel
  std::vector<std::vector<Index>> used_;    // places there
  Allocator claims_, switch_;
  std::vector<Index> turn_;                 // by way in: the channel that goes first
  std::vector<std::vector<Index>> asking_;  // by way in and out: the channel
};

/// The terminal of a router: it creates packets, and takes those that have come.
class Node {
 public:
  Node(const Rules& rules, Index nodes, Link& in, Link& out)
      : rules_(rules), nodes_(nodes), in_(in), out_(out), used_(rules.channels), last_(rules.channels - 1) {}

  /// Returns how many flits have come.
  int step(std::int64_t now, std::mt19937_64& random) {
    int accepted = 0;
    out_.flits.take(now, [&](const Flit& flit) {
      ++accepted;
      out_.credits.put(now + 2, flit.channel);
    });
    in_.credits.take(now, [&](Index channel) { --used_[channel]; });
    create(now, random);
    if (packet_.empty()) return accepted;
    Flit& flit = packet_.front();
    for (Index i = 1; flit.head && flit.channel == kNone && i <= rules_.channels; ++i)
      if (const Index channel = (last_ + i) % rules_.channels; used_[channel] < rules_.places) flit.channel = channel;
    if (flit.channel == kNone || used_[flit.channel] == rules_.places) return accepted;
    last_ = flit.channel;
    ++used_[last_];
    in_.flits.put(now + 2, flit);
    packet_.pop_front();
    if (!packet_.empty()) packet_.front().channel = last_;
    return accepted;
  }

 private:
  /// The next packet comes when the one before it has left, but as if it had waited.
  void create(std::int64_t now, std::mt19937_64& random) {
    std::bernoulli_distribution draw(rules_.offered / rules_.flits);
    for (; packet_.empty() && created_ <= now; ++created_) {
      if (!draw(random)) continue;
      const Index to = random() % nodes_;
      for (int i = 0; i < rules_.flits; ++i) packet_.push_back({to, i == 0, i + 1 == rules_.flits});
    }
  }

  const Rules& rules_;
  Index nodes_;
  Link &in_, &out_;
  std::vector<Index> used_;  // places by channel
  Index last_;               // the channel of the last flit
  std::deque<Flit> packet_;
  std::int64_t created_ = 0;
};

/// By router, and by destination the router after it: shortest by latency, ties to the lower number.
std::vector<std::vector<Index>> next_routers(Index routers, const std::deque<Link>& links) {
  constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max() / 2;
  std::vector<std::vector<Index>> next(routers, std::vector<Index>(routers, kNone));
  for (Index start = 0; start < routers; ++start) {
    std::vector<std::int64_t> distance(routers, kFar);
    std::vector<bool> done(routers);
    distance[start] = 0;
    for (;;) {
      Index at = kNone;
      for (Index r = 0; r < routers; ++r)
        if (!done[r] && distance[r] < kFar && (at == kNone || distance[r] < distance[at])) at = r;
      if (at == kNone) break;
      done[at] = true;
      for (const Link& link : links) {
        if (link.from != at || distance[at] + link.latency >= distance[link.to]) continue;
        distance[link.to] = distance[at] + link.latency;
        next[start][link.to] = at == start ? link.to : next[start][at];
      }
    }
  }
  return next;
}

double accepted(const Rules& rules, std::uint64_t seed) {
  Index nodes = 0, others = 0;
  std::cin >> nodes >> others;
  std::deque<Link> links;
  for (Link link; std::cin >> link.from >> link.to >> link.latency;) links.push_back(link);
  const Index many = nodes + others;
  const std::vector<std::vector<Index>> next = next_routers(many, links);
  std::vector<std::vector<Link*>> in(many), out(many);
  std::deque<Link> own(2 * nodes);  // of node and router
  for (Index n = 0; n < nodes; ++n) {
    in[n].push_back(&own[2 * n]);
    out[n].push_back(&own[2 * n + 1]);
  }
  for (Link& link : links) {
    out[link.from].push_back(&link);
    in[link.to].push_back(&link);
  }
  std::vector<std::vector<Index>> exits(many, std::vector<Index>(nodes));
  for (Index r = 0; r < many; ++r)
    for (Index to = 0; to < nodes; ++to)
      for (Index o = r < nodes ? 1 : 0; o < out[r].size() && to != r; ++o)
        if (out[r][o]->to == next[r][to]) exits[r][to] = o;
  std::deque<Router> routers;
  std::deque<Node> ends;
  for (Index r = 0; r < many; ++r) routers.emplace_back(rules, in[r], out[r]);
  for (Index n = 0; n < nodes; ++n) ends.emplace_back(rules, nodes, own[2 * n], own[2 * n + 1]);
  std::mt19937_64 random(seed);
  std::int64_t flits = 0;
  for (std::int64_t now = 0; now < 2 * kWindow; ++now) {
    for (Node& node : ends) flits += node.step(now, random) * (now >= kWindow ? 1 : 0);
    for (Index r = 0; r < many; ++r) routers[r].step(now, exits[r]);
  }
  return static_cast<double>(flits) / static_cast<double>(nodes) / static_cast<double>(kWindow);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) {
    std::fputs("usage: router_model OFFERED FLITS CHANNELS PLACES SPECULATIVE SEED < GRAPH\n", stderr);
    return 2;
  }
  const Rules rules{std::atof(argv[1]), std::atoi(argv[2]), static_cast<Index>(std::atoi(argv[3])),
                    static_cast<Index>(std::atoi(argv[4])), std::atoi(argv[5]) != 0};
  std::printf("%.6f\n", accepted(rules, std::strtoull(argv[6], nullptr, 10)));
  return 0;
}
