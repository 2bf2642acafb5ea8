#pragma once
// The annotations of the sources as rows of the linear program.

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "analysis.hpp"
#include "flow_constraints.hpp"
#include "linear_program.hpp"

namespace tactree::wcet {

/// A limit that names open parameters: counted <= (fixed + sum of per * value) * entered.
struct OpenLimit {
  std::string where;
  std::size_t row = 0;
  Terms counted;
  Terms entered;
  double fixed = 0.0;
  std::map<std::string, double> per;
};

class AnnotationLimits {
 public:
  /// All arguments must outlive the object. Rows are added to `program`.
  AnnotationLimits(const Analysis& analysis, const NameValues& values, const FlowConstraints& flow,
                   LinearProgram& program)
      : analysis_(analysis), values_(values), flow_(flow), program_(program) {}

  /// Throws BoundError on an annotation that cannot be applied.
  void add();

  [[nodiscard]] const std::vector<OpenLimit>& open() const { return open_; }
  /// `at most:` annotations that apply to some instruction.
  [[nodiscard]] const std::set<const SourceFact*>& used_facts() const { return used_facts_; }

 private:
  /// Statements and loops that are counted together.
  struct Group {
    const Total* first = nullptr;
    std::string file;
    std::string where;
    Terms terms;
  };
  using Groups = std::map<std::pair<std::string, std::string>, Group>;  // by function and name

  void limit_loop(std::uint32_t entry, std::uint32_t number);
  [[nodiscard]] Terms bodies(std::uint32_t entry, std::uint32_t number) const;
  void limit_loop_totals(Groups& groups);
  void limit_fact(const SourceFact& fact, Groups& groups);
  [[nodiscard]] bool is_of(const ControlFlow& flow, std::uint32_t index,
                           const SourceFact& fact) const;
  [[nodiscard]] bool has_code(const SourceFact& fact) const;
  [[nodiscard]] bool has_store(const ControlFlow& flow, const Block& block,
                               const SourceFact& fact) const;
  void limit_alone_or_together(const Terms& terms, const Total& total, const std::string& file,
                               std::uint32_t line, Groups& groups);
  void limit_total(const Terms& counted, const Total& total, const std::string& file,
                   const std::string& where);
  void limit_to(const Terms& counted, const Expression& limit, const std::string& file,
                const Terms& entered);
  void check_linear(const OpenLimit& open, const Expression& limit, const std::string& file) const;

  const Analysis& analysis_;
  const NameValues& values_;
  const FlowConstraints& flow_;
  LinearProgram& program_;
  std::set<const SourceFact*> used_facts_;
  std::vector<OpenLimit> open_;
};

}  // namespace tactree::wcet
