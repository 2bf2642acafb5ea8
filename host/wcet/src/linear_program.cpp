#include "linear_program.hpp"

#include <glpk.h>

#include <memory>

namespace tactree::wcet {

int LinearProgram::add_variable(double gain) {
  gains_.push_back(gain);
  return static_cast<int>(gains_.size()) - 1;
}

LinearProgram::Solution LinearProgram::solve() const {
  const std::unique_ptr<glp_prob, decltype(&glp_delete_prob)> problem(glp_create_prob(),
                                                                      &glp_delete_prob);
  glp_set_obj_dir(problem.get(), GLP_MAX);
  glp_add_cols(problem.get(), static_cast<int>(gains_.size()));
  for (std::size_t i = 0; i < gains_.size(); ++i) {
    glp_set_col_bnds(problem.get(), static_cast<int>(i) + 1, GLP_LO, 0.0, 0.0);
    glp_set_obj_coef(problem.get(), static_cast<int>(i) + 1, gains_[i]);
  }
  glp_add_rows(problem.get(), static_cast<int>(rows_.size()));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    std::vector<int> columns{0};
    std::vector<double> values{0.0};
    for (const auto& [variable, coefficient] : row.terms) {
      columns.push_back(variable + 1);
      values.push_back(coefficient);
    }
    const int number = static_cast<int>(i) + 1;
    glp_set_row_bnds(problem.get(), number, row.equal ? GLP_FX : GLP_UP, row.value, row.value);
    glp_set_mat_row(problem.get(), number, static_cast<int>(columns.size()) - 1, columns.data(),
                    values.data());
  }
  glp_smcp options;
  glp_init_smcp(&options);
  options.msg_lev = GLP_MSG_OFF;
  options.presolve = GLP_ON;
  Solution solution;
  if (glp_simplex(problem.get(), &options) != 0 || glp_get_status(problem.get()) != GLP_OPT) {
    return solution;
  }
  solution.bounded = true;
  solution.gain = glp_get_obj_val(problem.get());
  for (std::size_t i = 0; i < gains_.size(); ++i) {
    solution.x.push_back(glp_get_col_prim(problem.get(), static_cast<int>(i) + 1));
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    solution.price.push_back(glp_get_row_dual(problem.get(), static_cast<int>(i) + 1));
  }
  return solution;
}

}  // namespace tactree::wcet
