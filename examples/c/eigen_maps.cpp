// Matrices of Eigen, in the order of storage that they have: `eigen_maps` checks two triangles in matrices V x 3 and F x 3, column by
// column as libigl has them: at rest, where they are apart, and at q = (0.5), where they cross. Prints the pairs.
#include <Eigen/Core>
#include <cstdio>

#include "sscc/sscc.hpp"

int main() {
  Eigen::MatrixXd V(6, 3);
  V << 0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 2, 1, 1, 4, 2, 1, 4;
  Eigen::MatrixXi F(2, 3);
  F << 0, 1, 2, 3, 4, 5;
  auto detector = sscc::detector::make(sscc::map(V), sscc::map(F));
  std::printf("at rest: %zu pairs\n", detector.discrete(sscc::map(V)).size());

  // One mode, which moves the second triangle down: 3V x 1, x, y, z of the first vertex first.
  Eigen::MatrixXd U = Eigen::MatrixXd::Zero(18, 1);
  for (int vertex = 3; vertex < 6; ++vertex) U(3 * vertex + 2, 0) = -5;
  const auto model = sscc::model::make(sscc::map(V), sscc::map(F), sscc::map(U));
  auto query = sscc::query::make(model, sscc::certificates::compute(model));
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.5);
  for (const sscc::pair& p : query.discrete(q)) std::printf("at q: %u %u\n", p.a, p.b);

  // The positions at q, as a map of the memory of sscc, row by row.
  const std::vector<double> x = model.positions(q);
  using rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const Eigen::Map<const rows> X(x.data(), 6, 3);
  std::printf("detector: %zu pairs\n", detector.discrete(sscc::map(X)).size());
}
