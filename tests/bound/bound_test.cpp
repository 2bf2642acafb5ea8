// Bounds and refusals of the analysis, on small images.

#include <random>
#include <vector>

#include "sample_image.hpp"

namespace tactree::test {
namespace {

// Work that no compiler evaluates at compile time, unrolls or replaces by a library call.
const std::string kWork = R"(
volatile int work;
[[gnu::noinline]] void leaf() { work = work + 1; }
volatile unsigned wanted;
)";

std::string looping(const std::string& bound) {
  return kWork + R"(
extern "C" void tick() {
  const unsigned count = wanted;
  for (unsigned i = 0; i < count; ++i) {  // bound: )" +
         bound + R"(
    leaf();
  }
})";
}

class Bounding : public SampleImage {};

TEST_F(Bounding, CountsStraightLineInstructions) {
  const wcet::Bound bound = bound_of(R"(extern "C" [[gnu::naked]] void tick() {
    __asm volatile("movs r0, #1\n\t adds r0, #2\n\t bx lr");
  })");
  EXPECT_EQ(bound.instructions, 3U);
}

TEST_F(Bounding, TakesLongerBranch) {
  const wcet::Bound bound = bound_of(R"(extern "C" [[gnu::naked]] void tick() {
    __asm volatile("cmp r0, #1\n\t beq 1f\n\t nop\n\t nop\n\t nop\n 1:\n\t bx lr");
  })");
  EXPECT_EQ(bound.instructions, 6U);
}

TEST_F(Bounding, ScalesLinearlyWithLoopBound) {
  const std::uint64_t ten = bound_of(looping("10")).instructions;
  const std::uint64_t twenty = bound_of(looping("20")).instructions;
  const std::uint64_t thirty = bound_of(looping("2 * (10 + 5)")).instructions;
  EXPECT_EQ(thirty - twenty, twenty - ten);
  EXPECT_EQ((twenty - ten) % 10, 0U);
  EXPECT_GE(twenty - ten, 10U * 7U);  // the leaf's load, addition, store and return, and the loop
}

TEST_F(Bounding, AcceptsParametersAndConstants) {
  const std::uint64_t ten = bound_of(looping("10")).instructions;
  EXPECT_EQ(bound_of(looping("points"), {{"points", 10}}).instructions, ten);
  EXPECT_EQ(bound_of("constexpr unsigned kTwo = 2;\nconstexpr unsigned kTen = kTwo * 5U;\n" +
                     looping("kTen"))
                .instructions,
            ten);
}

TEST_F(Bounding, ReportsLoopsAndFunctions) {
  const wcet::Bound bound = bound_of(looping("10"));
  ASSERT_EQ(bound.loops.size(), 1U);
  EXPECT_EQ(bound.loops[0].file, "sample.cpp");
  EXPECT_EQ(bound.loops[0].line, 8U);
  EXPECT_EQ(bound.loops[0].passes, 10);
  ASSERT_EQ(bound.functions.size(), 2U);
  double sum = 0.0;
  for (const wcet::FunctionOnPath& function : bound.functions) {
    sum += function.instructions;
    EXPECT_EQ(function.calls, function.name == "tick" ? 1.0 : 10.0) << function.name;
  }
  EXPECT_NEAR(sum, static_cast<double>(bound.instructions), 1e-3);
}

TEST_F(Bounding, LimitsLoopEntriesByTotal) {
  const auto nested = [](const std::string& inner) {
    return kWork + R"(
extern "C" void tick() {
  for (unsigned i = 0; i < wanted; ++i) {  // bound: 8
    // bound: )" +
           inner + R"(
    for (unsigned j = 0; j < wanted; ++j) {
      leaf();
    }
  }
})";
  };
  const wcet::Bound each = bound_of(nested("50"));
  const wcet::Bound all = bound_of(nested("50, total 60 per tick"));
  const auto calls = [](const wcet::Bound& bound) {
    for (const wcet::FunctionOnPath& function : bound.functions) {
      if (function.name == "leaf()") {
        return function.calls;
      }
    }
    return 0.0;
  };
  EXPECT_NEAR(calls(each), 400.0, 1e-6);
  EXPECT_NEAR(calls(all), 60.0, 1e-6);
}

TEST_F(Bounding, LimitsStatement) {
  const auto limited = [](const std::string& comment) {
    return kWork + R"(
[[gnu::noinline]] void dear() { leaf(); leaf(); leaf(); leaf(); }
extern "C" void tick() {
  for (unsigned i = 0; i < wanted; ++i) {  // bound: 10
    if (work == 7) {
      dear();  // )" +
           comment + R"(
    } else {
      leaf();
    }
  }
})";
  };
  const wcet::Bound free = bound_of(limited(""));
  const wcet::Bound limited_to_3 = bound_of(limited("at most: 3 per tick"));
  const wcet::Bound without = bound_of(limited("at most: 0 per tick"));
  EXPECT_LT(limited_to_3.instructions, free.instructions);
  EXPECT_LT(without.instructions, limited_to_3.instructions);
  EXPECT_TRUE(limited_to_3.unused_facts.empty());
}

// A formatter may put the call of a statement on another line than its annotation.
TEST_F(Bounding, LimitsCallOnSecondLine) {
  const auto limited = [](const std::string& comment) {
    return kWork + R"(
[[gnu::noinline]] unsigned dear(unsigned by) { leaf(); leaf(); leaf(); return work + by; }
extern "C" void tick() {
  unsigned sum = 0;
  for (unsigned i = 0; i < wanted; ++i) {  // bound: 10
    if (work == 7) {
      // )" +
           comment +
           R"(
      sum +=
          dear(sum);
    }
  }
  work = sum;
})";
  };
  EXPECT_LT(bound_of(limited("at most: 3 per tick")).instructions,
            bound_of(limited("")).instructions);
}

TEST_F(Bounding, RefusesLimitWithoutCall) {
  EXPECT_NE(refusal("// at most: 1 per tick\n\n" + looping("10")).find("belongs to no statement"),
            std::string::npos);
  const std::string arithmetic = kWork + R"(
extern "C" unsigned tick() {
  unsigned sum = work;
  for (unsigned i = 0; i < wanted; ++i) {  // bound: 10
    leaf();
    // at most: 3 per tick
    sum = sum * 5U + work;
  }
  return sum;
})";
  EXPECT_NE(refusal(arithmetic).find("sample.cpp:"), std::string::npos);
  EXPECT_NE(refusal(arithmetic).find("belongs to no call or store"), std::string::npos);
}

// The branch is taken on the shorter path only.
TEST_F(Bounding, UntakenBranchCostsOneCycle) {
  const auto cycles = [&](const std::string& branch) {
    return bound_of(R"(extern "C" [[gnu::naked]] void tick() {
  asm volatile("cmp r0, #0\n )" +
                        branch + R"(\n nop\n nop\n nop\n nop\n nop\n nop\n 1: bx lr");
})",
                    {}, wcet::find_timing("mps2-an386"))
        .cycles;
  };
  EXPECT_EQ(cycles("beq 1f"), cycles("nop"));
}

TEST_F(Bounding, AnalysesCallsWithTheirArguments) {
  const auto clearing = [](const std::string& calls) {
    return kWork + R"(
[[gnu::noinline, gnu::noclone, gnu::noipa]] void clear(char* to, unsigned bytes) {
  for (unsigned i = 0; i < bytes; ++i) {  // bound: bytes
    *const_cast<volatile char*>(to + i) = 0;
  }
}
char buffer[100];
extern "C" void tick() { )" +
           calls + " }";
  };
  const std::uint64_t ten = bound_of(clearing("clear(buffer, 10); work = 1;")).instructions;
  const std::uint64_t twenty = bound_of(clearing("clear(buffer, 20); work = 1;")).instructions;
  const std::uint64_t both =
      bound_of(clearing("clear(buffer, 10); clear(buffer, 20); work = 1;")).instructions;
  EXPECT_GT(twenty, ten);
  EXPECT_GT(both, twenty);
  EXPECT_LT(both, ten + twenty);
  const std::string refused = refusal(clearing("clear(buffer, wanted); work = 1;"));
  EXPECT_NE(refused.find("an argument 'bytes' that is not a constant"), std::string::npos)
      << refused;
}

TEST_F(Bounding, FollowsJumpTable) {
  const wcet::Bound bound = bound_of(kWork + R"(
[[gnu::noinline]] void many() { leaf(); leaf(); leaf(); leaf(); leaf(); leaf(); }
extern "C" void tick() {
  switch (wanted) {
    case 0: work = 3; break;
    case 1: leaf(); work = 7; break;
    case 2: work = work * 3; break;
    case 3: many(); break;
    case 4: work = work - 9; break;
    case 5: leaf(); leaf(); break;
    case 6: work = work / 3; break;
    default: break;
  }
})");
  bool passes_many = false;
  for (const wcet::FunctionOnPath& function : bound.functions) {
    passes_many = passes_many || (function.name == "many()" && function.calls == 1.0);
  }
  EXPECT_TRUE(passes_many);
}

TEST_F(Bounding, ExcludesNonReturningPaths) {
  const std::string code = kWork + R"(
[[gnu::noinline, noreturn]] void stop() { while (true) { work = 1; } }  // bound: for_ever
extern "C" void tick() {
  if (wanted == 77) {
    stop();
  }
  leaf();
})";
  const wcet::Bound bound = bound_of(code);
  EXPECT_EQ(bound.endings.size(), 1U);
  EXPECT_LT(bound.instructions, 20U);
}

TEST_F(Bounding, RefusesLoopWithoutBound) {
  const std::string refused = refusal(kWork + R"(
extern "C" void tick() {
  for (unsigned i = 0; i < wanted; ++i) {
    leaf();
  }
})");
  EXPECT_NE(refused.find("sample.cpp:7: a loop that has no bound"), std::string::npos) << refused;
}

TEST_F(Bounding, RefusesUnanalysableCode) {
  struct Case {
    const char* code;
    const char* cause;
  };
  const Case cases[] = {
      {R"(volatile int n; [[gnu::noinline]] int f(int i) { return i < 2 ? n : f(i - 1) * f(i - 2); }
          extern "C" void tick() { n = f(n); })",
       "calls itself"},
      {R"(void (*volatile to)(); volatile int n; extern "C" void tick() { to(); n = 1; })",
       "indirect call"},
      {R"(void (*volatile to)(); extern "C" void tick() { to(); })", "indirect jump"},
      {R"(extern "C" void tick() { __asm volatile(".inst.w 0xfeefffff"); })",
       "unknown instruction"},
      {R"(extern "C" void tick() { __asm volatile("svc #0"); })", "calls an exception handler"},
  };
  for (const Case& c : cases) {
    const std::string refused = refusal(c.code);
    EXPECT_NE(refused.find(c.cause), std::string::npos) << c.code << "\n" << refused;
    EXPECT_NE(refused.find("sample.cpp:"), std::string::npos) << refused;
  }
}

TEST_F(Bounding, RefusesMalformedBound) {
  EXPECT_NE(refusal(looping("points")).find("'points' is unknown"), std::string::npos);
  EXPECT_NE(
      refusal(looping("2 points")).find("sample.cpp:8: ' points' is not part of the annotation"),
      std::string::npos);
  EXPECT_NE(refusal(looping("")).find("no expression begins"), std::string::npos);
  EXPECT_NE(refusal(looping("10 / 0")).find("divides by zero"), std::string::npos);
  EXPECT_NE(refusal(looping("5, total 3 per other")).find("other is not a function of the image"),
            std::string::npos);
}

TEST_F(Bounding, RefusesOtherFiles) {
  const auto refused = [&](const std::filesystem::path& file) {
    return message_of<wcet::BoundError>([&] { (void)bound_of_image(file); });
  };
  EXPECT_NE(refused(folder_ / "missing.elf").find("cannot be read"), std::string::npos);
  EXPECT_NE(refused("/bin/sh").find("not a linked image of an Arm core"), std::string::npos);
  EXPECT_NE(refused(write("text.elf", "hello")).find("not a linked image"), std::string::npos);
}

/// The bound of the last compiled image, with entries and sources of its own.
wcet::Bound bound_from(const std::filesystem::path& folder, const std::string& entry,
                       const std::vector<std::filesystem::path>& sources) {
  wcet::BoundOptions options;
  options.image = folder / "sample.elf";
  options.sources = sources;
  options.entries = {{entry, 1}};
  return wcet::worst_case(options);
}

TEST_F(Bounding, ReadsSourcesOfSeveralFolders) {
  for (const char* name : {"lib", "own", "own/lib"}) {
    std::filesystem::create_directory(folder_ / name);
  }
  write("lib/part.hpp", kWork + R"(
inline void repeat() {
  for (unsigned i = 0; i < wanted; ++i) {  // bound: 10
    leaf();
  }
})");
  const std::uint64_t instructions =
      bound_of("#include \"lib/part.hpp\"\nextern \"C\" void tick() { repeat(); }").instructions;
  const auto from = [&](const std::vector<std::filesystem::path>& sources) {
    return bound_from(folder_, "tick", sources);
  };
  const wcet::Bound bound = from({folder_ / "own", folder_ / "lib/", folder_ / "own"});
  EXPECT_EQ(bound.instructions, instructions);
  ASSERT_EQ(bound.loops.size(), 1U);
  EXPECT_EQ(bound.loops[0].file, "lib/part.hpp");
  EXPECT_EQ(from({folder_ / "lib"}).loops[0].file, "part.hpp");
  EXPECT_EQ(from({folder_ / "own", folder_ / "own/lib", folder_ / "lib"}).loops[0].file,
            (folder_ / "lib/part.hpp").lexically_normal());
  const auto refused = [&](const std::vector<std::filesystem::path>& sources) {
    return message_of<wcet::BoundError>([&] { (void)from(sources); });
  };
  EXPECT_NE(refused({folder_ / "own"}).find("matches no loop in the source"), std::string::npos);
  EXPECT_NE(refused({folder_ / "none"}).find("is not a folder"), std::string::npos);
}

TEST_F(Bounding, FindsEntryByNameInSource) {
  const std::uint64_t instructions = bound_of(kWork + R"(
namespace part {
[[gnu::used, gnu::noipa]] void step() { leaf(); }
[[gnu::used, gnu::noipa]] void twice(int) { leaf(); }
[[gnu::used, gnu::noipa]] void twice(char) { leaf(); }
namespace {
[[gnu::used, gnu::noipa]] void hidden() { leaf(); }
}
}
extern "C" void tick() { leaf(); })")
                                         .instructions;
  for (const char* name :
       {"tick", "part::step", "part::step()", "part::hidden", "part::twice(char)"}) {
    EXPECT_EQ(bound_from(folder_, name, {folder_}).instructions, instructions) << name;
  }
  const auto refused = [&](const char* name) {
    return message_of<wcet::BoundError>([&] { (void)bound_from(folder_, name, {folder_}); });
  };
  EXPECT_NE(refused("part::twice").find("are both named part::twice"), std::string::npos);
  EXPECT_NE(refused("part").find("has no function part"), std::string::npos);
}

// A compiler that changes the arguments of a function keeps its body, under another symbol.
TEST_F(Bounding, FindsEntryThatIsCloned) {
  const std::uint64_t instructions = bound_of(kWork + R"(
namespace part {
[[gnu::used, gnu::noipa]] void step() asm("_ZN4part4stepEv.isra.0");
void step() { leaf(); }
[[gnu::used, gnu::noipa]] void given() asm("_ZN4part5givenEv.constprop.1.isra.12");
void given() { leaf(); }
[[gnu::used, gnu::noipa]] void cut() asm("_ZN4part3cutEv.part.0");
void cut() { leaf(); }
[[gnu::used, gnu::noipa]] void cut_again() asm("_ZN4part3cutEv.constprop.0.cold");
void cut_again() { leaf(); }
[[gnu::used, gnu::noipa]] void twice(int) { leaf(); }
[[gnu::used, gnu::noipa]] void twice_given() asm("_ZN4part5twiceEi.constprop.0");
void twice_given() { leaf(); }
}
extern "C" void tick() { leaf(); })")
                                         .instructions;
  for (const char* name : {"part::step", "part::step()", "part::given", "_ZN4part3cutEv.part.0"}) {
    EXPECT_EQ(bound_from(folder_, name, {folder_}).instructions, instructions) << name;
  }
  const auto refused = [&](const char* name) {
    return message_of<wcet::BoundError>([&] { (void)bound_from(folder_, name, {folder_}); });
  };
  EXPECT_NE(refused("part::cut").find("has no function part::cut"), std::string::npos);
  EXPECT_NE(refused("part::twice").find("_ZN4part5twiceEi.constprop.0"), std::string::npos);
  EXPECT_NE(refused("part::twice").find("are both named part::twice"), std::string::npos);
}

// The condition alone is the loop of the machine code, and is evaluated once more than the bound.
TEST_F(Bounding, CountsConditionOfLoopWithoutBody) {
  const auto waiting = [](const std::string& bound) {
    return kWork + R"(
extern "C" void tick() {
  while (work == 7) {  // bound: )" +
           bound + R"(
  }
})";
  };
  const wcet::Bound none = bound_of(waiting("0"));
  ASSERT_EQ(none.loops.size(), 1U);
  EXPECT_EQ(none.loops[0].total, 1.0);
  const wcet::Bound three = bound_of(waiting("3"));
  EXPECT_EQ(three.loops[0].total, 4.0);
  EXPECT_GE(three.instructions, none.instructions + 3U * 3U);  // load, compare, branch
}

// 1 kHz and 2 kHz end the first two tiers.
TEST(HighestRate, SeparatesTimelyFromLateTicks) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> cycles(1e3, 1e5);
  for (int board = 0; board < 1000; ++board) {
    wcet::WorkTierCycles tiers{};
    for (double& of_tier : tiers) {
      of_tier = cycles(random);
    }
    constexpr double kClock = 5e7;
    const double highest = wcet::highest_rate(kClock, tiers);
    for (double rate_hz = 50.0; rate_hz < 60000.0; rate_hz *= 1.07) {
      const std::uint32_t tier = wcet::work_tier_in_time(rate_hz, kClock, tiers);
      EXPECT_GE(tier, core::work_tier_of(static_cast<float>(rate_hz)));
      EXPECT_EQ(tiers[tier] * rate_hz <= kClock, rate_hz <= highest) << rate_hz << " Hz";
    }
  }
}

}  // namespace
}  // namespace tactree::test
