#include "ringbus/cycle/shading/programs/shade_core.h"

#include <algorithm>
#include <utility>

#include "ringbus/cycle/shading/programs/data_lines.h"

namespace carousel::ringbus::cycle {

namespace {

using Counts = ShadeProgramCounts;

/// The count of each class of instructions, in the order of OpClass.
constexpr std::array<std::uint64_t Counts::*, kOpClasses> kByClass{&Counts::simple, &Counts::product, &Counts::divide,
                                                                   &Counts::branch, &Counts::read,    &Counts::texture,
                                                                   &Counts::trace};

}  // namespace

void ShadeCore::begin(std::size_t at, std::vector<Ray>&& rays, Cycle now) {
  Vector& v = vectors_[at];
  v.rays = std::move(rays);
  v.runs.clear();
  std::vector<std::uint32_t> programs;
  for (std::uint32_t i = 0; i < v.rays.size(); ++i) {
    const std::uint32_t program = programs_.of_kind[v.rays[i].kind];
    // The last run of this program has room, or another one begins.
    std::size_t run = programs.size();
    while (run > 0 && programs[run - 1] != program) --run;
    if (run == 0 || v.runs[run - 1].size() == lanes_) {
      programs.push_back(program);
      v.runs.emplace_back();
      run = programs.size();
    }
    v.runs[run - 1].push_back(i);
  }
  const std::uint32_t kind = v.rays.front().kind;
  if (kind == kAnyHitKind) counts_.any_hit_calls += v.rays.size();
  if (kind != kAnyHitKind && kind != kCameraKind) {
    ++vector_counts_.vectors;
    vector_counts_.rays += v.rays.size();
    vector_counts_.runs += v.runs.size();
  }
  v.run = 0;
  v.began = v.counted = now;
  begin_run(v, now);
  next_ = std::min(next_, now);
}

void ShadeCore::begin_run(Vector& v, Cycle now) {
  std::vector<const ShadeFacts*> facts;
  for (const std::uint32_t ray : v.runs[v.run]) facts.push_back(&v.rays[ray].facts);
  v.lanes.begin(programs_.programs[program_of(v)], facts);
  v.lookups.assign(facts.size(), 0);
  v.ready.fill(0);
  v.read.fill(false);
  v.stage = Stage::kDecide;
  v.at = now;
  v.after = &Counts::branch_stalls;
}

Cycle ShadeCore::occupy(Cycle cycles, Cycle now) {
  issue_free_ = std::max(issue_free_, now) + cycles;
  occupied_ += cycles;
  find_next();
  return issue_free_;
}

void ShadeCore::answer(const ProgramRead& read, Cycle now) {
  Vector& v = vectors_[read.vector];
  --v.reads;
  if (--v.missing[read.reg] > 0) return;
  v.ready[read.reg] = now + v.filter[read.reg];
  if (v.at != kNever) return;  // it waits for something else, or can issue
  v.at = now;
  next_ = std::min(next_, now);
}

void ShadeCore::wait(Vector& v, Stall why, Cycle until) {
  if (until <= v.counted) return;
  counts_.*why += until - v.counted;
  v.counted = until;
}

void ShadeCore::step(Cycle now, ProgramMemory* memory, std::vector<std::size_t>& ended) {
  if (next_ > now) return;
  for (std::size_t i = 0; i < vectors_.size(); ++i)
    if (vectors_[i].stage != Stage::kFree && advance(vectors_[i], now)) {
      counts_.vector_cycles += now - vectors_[i].began;
      vectors_[i].stage = Stage::kFree;
      ended.push_back(i);
    }
  std::size_t first = vectors_.size();
  for (std::size_t i = 0; i < vectors_.size() && issue_free_ <= now; ++i)
    if (vectors_[i].stage == Stage::kIssue && (first == vectors_.size() || vectors_[i].at < vectors_[first].at))
      first = i;
  if (first < vectors_.size()) issue(first, now, memory);
  find_next();
}

bool ShadeCore::advance(Vector& v, Cycle now) {
  for (;;) {
    if (v.at > now) return false;
    switch (v.stage) {
      case Stage::kFree:
      case Stage::kIssue:
        return false;
      case Stage::kDecide:
        wait(v, v.after, v.at);
        if (v.lanes.running()) {
          v.at = cache_.fetch(programs_.address[program_of(v)] + v.lanes.at() * kInstructionBytes, now);
          v.stage = Stage::kFetch;
          break;
        }
        // Its registers are free when all reads have come.
        if (v.reads > 0) {
          v.after = &Counts::memory_stalls;
          v.at = kNever;
          return false;
        }
        if (++v.run == v.runs.size()) return true;
        begin_run(v, now);
        break;
      case Stage::kFetch:
        wait(v, &Counts::instruction_stalls, v.at);
        v.stage = Stage::kOperands;
        break;
      case Stage::kOperands:
        if (!operands_are_there(v, now)) return false;
        v.stage = Stage::kIssue;
        v.at = now;
        return false;
    }
  }
}

bool ShadeCore::operands_are_there(Vector& v, Cycle now) {
  const Instruction& i = v.lanes.next();
  Cycle read = 0, computed = 0;
  for (const std::uint8_t reg : {i.a, i.b, i.c, i.d}) {
    if (v.missing[reg] > 0) {
      v.at = kNever;
      return false;
    }
    Cycle& of = v.read[reg] ? read : computed;
    of = std::max(of, v.ready[reg]);
  }
  v.at = std::max({read, computed, now});
  if (v.at > now) return false;
  wait(v, &Counts::memory_stalls, read);
  wait(v, &Counts::operand_stalls, computed);
  return true;
}

void ShadeCore::issue(std::size_t at, Cycle now, ProgramMemory* memory) {
  Vector& v = vectors_[at];
  const Instruction& i = v.lanes.next();
  const auto latency = static_cast<Cycle>(programs_.programs[program_of(v)].latencies[static_cast<std::size_t>(i.of)]);
  wait(v, &Counts::issue_stalls, now);
  v.counted = now + 1;
  ++counts_.issued;
  counts_.*kByClass[static_cast<std::size_t>(i.of)] += v.lanes.active_lanes();
  issue_free_ = now + 1;
  v.stage = Stage::kDecide;
  v.at = now + 1;
  if (i.of == OpClass::kBranch || i.of == OpClass::kTrace) {
    v.after = i.of == OpClass::kBranch ? &Counts::branch_stalls : &Counts::trace_stalls;
    v.at = now + latency;
  } else {
    const std::uint32_t asked = i.of == OpClass::kRead || i.of == OpClass::kTexture ? ask(at, i, now, memory) : 0;
    v.read[i.d] = i.of == OpClass::kRead || i.of == OpClass::kTexture;
    v.ready[i.d] = now + std::max<Cycle>(latency, 1);
    v.missing[i.d] = asked;
    v.filter[i.d] = latency;
    v.reads += asked;
  }
  v.lanes.execute();
}

/// Asks for what the lanes read; returns the number of reads.
std::uint32_t ShadeCore::ask(std::size_t at, const Instruction& i, Cycle now, ProgramMemory* memory) {
  Vector& v = vectors_[at];
  std::vector<DataRead> reads;
  const ShadeData what = i.of == OpClass::kTexture ? ShadeData::kTexels : static_cast<ShadeData>(i.target);
  const std::vector<std::uint32_t>& run = v.runs[v.run];
  for (std::size_t lane = 0; lane < run.size(); ++lane) {
    if (!(v.lanes.active() >> lane & 1)) continue;
    const ShadeFacts& facts = v.rays[run[lane]].facts;
    const auto add = [&](const std::vector<DataRead>& more) { reads.insert(reads.end(), more.begin(), more.end()); };
    if (what == ShadeData::kMaterial) add(facts.material);
    if (what == ShadeData::kVertices) add(facts.vertices);
    if (what == ShadeData::kTexels && v.lookups[lane] < facts.lookups.size()) add(facts.lookups[v.lookups[lane]++]);
  }
  if (memory == nullptr) return 0;
  by_line(reads, memory->line_bytes());
  const ProgramRead by{.worker = worker_, .vector = static_cast<std::uint32_t>(at), .reg = i.d};
  for (const DataRead& read : reads) memory->read(what, read, by, now);
  counts_.data_reads += reads.size();
  return static_cast<std::uint32_t>(reads.size());
}

void ShadeCore::find_next() {
  next_ = kNever;
  for (const Vector& v : vectors_)
    if (v.stage != Stage::kFree) next_ = std::min(next_, v.stage == Stage::kIssue ? std::max(v.at, issue_free_) : v.at);
}

}  // namespace carousel::ringbus::cycle
