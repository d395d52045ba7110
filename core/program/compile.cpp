#include "core/program/compile.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "core/text/edit_distance.h"

namespace carousel {

namespace {

/// How an instruction is written: `kValue` writes its first register and reads the others.
enum class Form : std::uint8_t { kValue, kLoad, kHit, kLoop, kIf, kElse, kEnd, kBreak, kStop, kRead, kTrace };

struct OpRow {
  std::string_view name;
  Form form;
  Op op;
  OpClass of;
  std::size_t operands;  ///< those that have to be there
};

/// The one list of instructions.
constexpr auto kOpRows = std::to_array<OpRow>({
    {"load", Form::kLoad, Op::kLoad, OpClass::kSimple, 2},
    {"mov", Form::kValue, Op::kMove, OpClass::kSimple, 2},
    {"add", Form::kValue, Op::kAdd, OpClass::kSimple, 3},
    {"sub", Form::kValue, Op::kSub, OpClass::kSimple, 3},
    {"mul", Form::kValue, Op::kMul, OpClass::kProduct, 3},
    {"fma", Form::kValue, Op::kFma, OpClass::kProduct, 4},
    {"div", Form::kValue, Op::kDiv, OpClass::kDivide, 3},
    {"sqrt", Form::kValue, Op::kSqrt, OpClass::kDivide, 2},
    {"min", Form::kValue, Op::kMin, OpClass::kSimple, 3},
    {"max", Form::kValue, Op::kMax, OpClass::kSimple, 3},
    {"abs", Form::kValue, Op::kAbs, OpClass::kSimple, 2},
    {"neg", Form::kValue, Op::kNeg, OpClass::kSimple, 2},
    {"floor", Form::kValue, Op::kFloor, OpClass::kSimple, 2},
    {"lt", Form::kValue, Op::kLess, OpClass::kSimple, 3},
    {"le", Form::kValue, Op::kLessEqual, OpClass::kSimple, 3},
    {"eq", Form::kValue, Op::kEqual, OpClass::kSimple, 3},
    {"select", Form::kValue, Op::kSelect, OpClass::kSimple, 4},
    {"hit", Form::kHit, Op::kHit, OpClass::kSimple, 4},
    {"loop", Form::kLoop, Op::kLoop, OpClass::kBranch, 1},
    {"if", Form::kIf, Op::kIfZero, OpClass::kBranch, 1},
    {"else", Form::kElse, Op::kJump, OpClass::kBranch, 0},
    {"end", Form::kEnd, Op::kEnd, OpClass::kBranch, 0},
    {"break", Form::kBreak, Op::kIfNonzero, OpClass::kBranch, 0},
    {"stop", Form::kStop, Op::kIfNonzero, OpClass::kBranch, 0},
    {"read", Form::kRead, Op::kRead, OpClass::kRead, 2},
    {"texture", Form::kValue, Op::kTexture, OpClass::kTexture, 2},
    {"trace", Form::kTrace, Op::kTrace, OpClass::kTrace, 1},
});

/// What `read` names, in the order of ShadeData; `texture` reads texels.
constexpr auto kReadNames = std::to_array<std::string_view>({"material", "vertices"});

/// True for what a program of this use may have. The rows of kOpRows that shaders alone have stand last.
constexpr bool belongs(const OpRow& row, const ProgramUse& use) {
  const bool of_shaders = row.op == Op::kRead || row.op == Op::kTexture || row.op == Op::kTrace;
  return use.shades ? row.form != Form::kHit : !of_shaders;
}

/// True for break and stop, which may have a condition or none.
constexpr bool may_have_one(Form form) {
  return form == Form::kBreak || form == Form::kStop;
}

struct Word {
  std::string_view text;
  std::size_t column;
};

std::vector<Word> words_of(std::string_view text) {
  constexpr std::string_view kBetween = " \t,";
  std::vector<Word> out;
  for (std::size_t at = text.find_first_not_of(kBetween); at != text.npos;) {
    const std::size_t end = std::min(text.find_first_of(kBetween, at), text.size());
    out.push_back({text.substr(at, end - at), at});
    at = text.find_first_not_of(kBetween, end);
  }
  return out;
}

/// A set of registers, one bit each.
using Registers = std::uint64_t;
constexpr Registers kAll = ~Registers{0};  // of a place that is not reached

struct Failed {};

class Compiler {
 public:
  Compiler(std::span<const std::string> texts, const std::map<std::string, double>& parameters, ProgramFault& fault,
           const ProgramUse& use)
      : texts_(texts), parameters_(parameters), fault_(fault), use_(use) {
    for (const std::string_view input : use.inputs) names_.emplace_back(input);
    set_ = (Registers{1} << use.inputs.size()) - 1;
  }

  std::size_t registers() const { return names_.size(); }

  std::vector<Instruction> run() {
    if (texts_.empty()) fail(0, "expected instructions, found none");
    if (texts_.size() > kMostInstructions) {
      line_ = kMostInstructions;
      fail(0, fmt::format("expected {} instructions at most, found {}", kMostInstructions, texts_.size()));
    }
    for (line_ = 0; line_ < texts_.size(); ++line_) instruction();
    line_ = texts_.size() - 1;
    if (!blocks_.empty()) {
      line_ = blocks_.back().line;
      fail(0, fmt::format("expected an end of this {}, found the end of the program", blocks_.back().name()));
    }
    if (!hits_ && !use_.shades) fail(0, "expected a hit somewhere in the program, found none");
    for (const std::size_t at : stops_) code_[at].target = here();
    return std::move(code_);
  }

 private:
  struct Block {
    bool loop;
    std::size_t line, at;                ///< of the loop, if, or else
    bool otherwise = false;              ///< behind the else
    Registers before = 0, left = kAll;   ///< set before an if; set wherever control leaves for what is behind the end
    std::uint64_t times = 1, steps = 0;  ///< of a loop; steps of the block around, up to here
    std::uint8_t counter = 0;
    std::vector<std::size_t> breaks{};
    const char* name() const { return loop ? "loop" : "if"; }
  };

  [[noreturn]] void fail(std::size_t column, std::string message) {
    fault_ = {line_, column, std::move(message)};
    throw Failed{};
  }
  std::uint16_t here() const { return static_cast<std::uint16_t>(code_.size()); }

  void instruction() {
    const std::vector<Word> words = words_of(texts_[line_]);
    if (words.empty()) fail(0, "expected an instruction, found an empty text");
    const auto row = std::ranges::find(kOpRows, words[0].text, &OpRow::name);
    if (row == kOpRows.end() || !belongs(*row, use_)) unknown(words[0]);
    if (row->op == Op::kTrace && !use_.traces)
      fail(words[0].column,
           "an any-hit call sends no rays; expected another instruction, or another program for "
           "shading.program.any_hit, found trace");
    const std::size_t given = words.size() - 1;
    if (given != row->operands && !(may_have_one(row->form) && given == 1))
      fail(words[0].column, fmt::format("expected {} operands of {}{}, found {}", row->operands, row->name,
                                        may_have_one(row->form) ? " or 1" : "", given));
    ++steps_;
    one(*row, words);
    if (steps_ > kMostSteps)
      fail(0, fmt::format("a {} may then take {} instructions; expected smaller bounds of loops, so that it takes {} "
                          "at most",
                          use_.shades ? "ray" : "test", steps_, kMostSteps));
  }

  [[noreturn]] void unknown(const Word& word) {
    std::vector<std::string> names;
    for (const OpRow& row : kOpRows)
      if (belongs(row, use_)) names.emplace_back(row.name);
    const auto near = nearest_name(word.text, names);
    fail(word.column, fmt::format("expected an instruction, found '{}'{}", word.text,
                                  near ? fmt::format("; did you mean '{}'?", *near)
                                       : fmt::format("; known are {}", fmt::join(names, ", "))));
  }

  void one(const OpRow& row, const std::vector<Word>& words) {
    switch (row.form) {
      case Form::kValue: {
        std::uint8_t operand[3];
        for (std::size_t i = 0; i < 3; ++i) operand[i] = read(words[std::min(i + 2, words.size() - 1)]);
        const std::uint8_t to = written(words[1]);
        put(row, to, operand[0], operand[1], operand[2]);
        return;
      }
      case Form::kLoad: {
        const float value = number(words[2]);
        const std::uint8_t to = written(words[1]);
        put(row, to, to, to, to).value = value;
        return;
      }
      case Form::kHit: {
        std::uint8_t operand[4];
        for (std::size_t i = 0; i < 4; ++i) operand[i] = read(words[i + 1]);
        put(row, operand[0], operand[1], operand[2], operand[3]);
        hits_ = true;
        return;
      }
      case Form::kLoop:
        return open_loop(row, words[1]);
      case Form::kIf: {
        const std::uint8_t on = read(words[1]);
        blocks_.push_back({.loop = false, .line = line_, .at = code_.size(), .before = set_});
        put(row, on, on, on, on);
        return;
      }
      case Form::kElse:
        return open_else(row);
      case Form::kEnd:
        return close(row);
      case Form::kRead: {
        const auto what = std::ranges::find(kReadNames, words[2].text);
        if (what == kReadNames.end())
          fail(words[2].column,
               fmt::format("expected one of {}, found '{}'", fmt::join(kReadNames, ", "), words[2].text));
        const std::uint8_t to = written(words[1]);
        put(row, to, to, to, to).target = static_cast<std::uint16_t>(what - kReadNames.begin());
        return;
      }
      case Form::kTrace: {
        const std::uint8_t on = read(words[1]);
        put(row, on, on, on, on);
        return;
      }
      case Form::kBreak:
      case Form::kStop:
        return leave(row, words);
    }
  }

  Instruction& put(const OpRow& row, std::uint8_t d, std::uint8_t a, std::uint8_t b, std::uint8_t c) {
    return code_.emplace_back(Instruction{row.op, row.of, d, a, b, c, 0, 0});
  }

  std::uint8_t find(const Word& word) {
    const auto at = std::find(names_.begin(), names_.end(), word.text);
    return static_cast<std::uint8_t>(at - names_.begin());
  }
  void require_name(const Word& word) {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    const auto part = [&](char c) { return letter(c) || (c >= '0' && c <= '9'); };
    if (!letter(word.text[0]) || !std::all_of(word.text.begin(), word.text.end(), part))
      fail(word.column,
           fmt::format("expected the name of a register, found '{}'; a number is brought into one by load", word.text));
  }
  std::uint8_t read(const Word& word) {
    require_name(word);
    const std::uint8_t at = find(word);
    if (at < names_.size() && (set_ >> at & 1)) return at;
    std::vector<std::string> set;
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (set_ >> i & 1) set.push_back(names_[i]);
    const auto near = nearest_name(word.text, set);
    fail(word.column,
         at < names_.size()
             ? fmt::format("the register {} is not set on every way to this instruction", word.text)
             : fmt::format("expected a register that is set, found '{}'{}", word.text,
                           near ? fmt::format("; did you mean '{}'?", *near) : ", which no instruction has set"));
  }
  std::uint8_t written(const Word& word) {
    require_name(word);
    const std::uint8_t at = find(word);
    if (at < use_.inputs.size())
      fail(word.column, fmt::format("{} belongs to the ray and is only read; expected another register", word.text));
    if (at == names_.size()) {
      if (names_.size() == kMostRegisters)
        fail(word.column, fmt::format("expected {} registers at most, found one more: {}", kMostRegisters, word.text));
      names_.emplace_back(word.text);
    }
    set_ |= Registers{1} << at;
    return at;
  }
  float number(const Word& word) {
    float value = 0;
    const char* const end = word.text.data() + word.text.size();
    const auto [last, error] = std::from_chars(word.text.data(), end, value);
    if (error == std::errc{} && last == end && std::isfinite(value)) return value;
    if (error == std::errc::result_out_of_range && last == end)
      fail(word.column, fmt::format("expected a number that a float of 32 bits holds, found {}", word.text));
    if (const auto found = parameters_.find(std::string(word.text)); found != parameters_.end())
      return static_cast<float>(found->second);
    std::vector<std::string> names;
    for (const auto& [name, of] : parameters_) names.push_back(name);
    const auto near = nearest_name(word.text, names);
    fail(word.column, fmt::format("expected a number or the name of a parameter, found '{}'{}", word.text,
                                  near ? fmt::format("; did you mean '{}'?", *near) : ""));
  }

  void open_loop(const OpRow& row, const Word& word) {
    std::uint64_t times = 0;
    const char* const end = word.text.data() + word.text.size();
    const auto [last, error] = std::from_chars(word.text.data(), end, times);
    if (error != std::errc{} || last != end || times < 1 || times > kMostSteps)
      fail(word.column,
           fmt::format("a loop states its bound; expected an integer from 1 to {}, found '{}'", kMostSteps, word.text));
    const auto loops = static_cast<std::size_t>(std::ranges::count(blocks_, true, &Block::loop));
    if (loops == kMostLoops) fail(0, fmt::format("expected {} loops within one another at most", kMostLoops));
    const auto counter = static_cast<std::uint8_t>(loops);
    Instruction& made = put(row, 0, 0, 0, 0);
    made.c = counter;
    made.value = static_cast<float>(times);
    blocks_.push_back(
        {.loop = true, .line = line_, .at = code_.size(), .times = times, .steps = steps_, .counter = counter});
    steps_ = 0;
  }
  void open_else(const OpRow& row) {
    if (blocks_.empty() || blocks_.back().loop || blocks_.back().otherwise)
      fail(0, "expected an if before this else, found none that it belongs to");
    Block& block = blocks_.back();
    put(row, 0, 0, 0, 0);
    code_[block.at].target = here();
    block.at = code_.size() - 1;
    block.line = line_;
    block.otherwise = true;
    block.left = set_;
    set_ = block.before;
  }
  void close(const OpRow& row) {
    if (blocks_.empty()) fail(0, "expected a loop or an if before this end, found none that it belongs to");
    const Block block = std::move(blocks_.back());
    blocks_.pop_back();
    if (block.loop) {
      Instruction& made = put(row, 0, 0, 0, 0);
      made.c = block.counter;
      made.target = static_cast<std::uint16_t>(block.at);
      for (const std::size_t at : block.breaks) code_[at].target = here();
      set_ &= block.left;
      steps_ = block.steps + block.times * steps_;
      return;
    }
    // The end of an if is a mark alone.
    --steps_;
    code_[block.at].target = here();
    set_ &= block.otherwise ? block.left : block.before;
  }
  void leave(const OpRow& row, const std::vector<Word>& words) {
    const bool conditional = words.size() > 1;
    const std::uint8_t on = conditional ? read(words[1]) : std::uint8_t{0};
    const auto loop = std::find_if(blocks_.rbegin(), blocks_.rend(), [](const Block& block) { return block.loop; });
    if (row.form == Form::kBreak && loop == blocks_.rend()) fail(0, "expected a loop around this break, found none");
    Instruction& made = put(row, on, on, on, on);
    if (!conditional) made.op = Op::kJump;
    if (row.form == Form::kBreak) {
      loop->breaks.push_back(code_.size() - 1);
      loop->left &= set_;
    } else {
      stops_.push_back(code_.size() - 1);
    }
    if (!conditional) set_ = kAll;
  }

  std::span<const std::string> texts_;
  const std::map<std::string, double>& parameters_;
  ProgramFault& fault_;
  const ProgramUse& use_;
  std::size_t line_ = 0;
  std::vector<std::string> names_;  // of registers
  Registers set_;                   // on every way to here
  std::vector<Instruction> code_;
  std::vector<Block> blocks_;  // that are open
  std::vector<std::size_t> stops_;
  std::uint64_t steps_ = 0;  // of the innermost loop's body, at most
  bool hits_ = false;
};

}  // namespace

std::optional<RayProgram> compile_program(std::span<const std::string> texts,
                                          const std::map<std::string, double>& parameters, const OpLatencies& latencies,
                                          ProgramFault& fault, const ProgramUse& use) {
  try {
    Compiler compiler(texts, parameters, fault, use);
    RayProgram out{compiler.run(), latencies};
    out.registers = compiler.registers();
    return out;
  } catch (const Failed&) {
    return std::nullopt;
  }
}

}  // namespace carousel
