// Tests by the compiler alone that sscc::view accepts exactly the containers whose elements are contiguous.
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "sscc/sscc.hpp"

namespace {

using numbers = sscc::view<const double>;

template <class C>
constexpr bool is_taken = std::is_constructible_v<numbers, C>;

static_assert(is_taken<std::vector<double>&> && is_taken<const std::vector<double>&>);
static_assert(is_taken<std::array<double, 3>&> && is_taken<numbers>);
static_assert(!is_taken<std::vector<float>&> && !is_taken<double*>);
static_assert(!std::is_constructible_v<sscc::view<double>, const std::vector<double>&>);

// The members of Eigen's types that matter here.
template <bool is_vector, int inner_stride>
struct matrix_of_eigen {
  enum { IsVectorAtCompileTime = is_vector, InnerStrideAtCompileTime = inner_stride };
  const double* data() const;
  std::ptrdiff_t size() const;
};

static_assert(is_taken<matrix_of_eigen<true, 1>&> && is_taken<const matrix_of_eigen<true, 1>&>);
static_assert(!is_taken<matrix_of_eigen<true, -1>&> && !is_taken<matrix_of_eigen<true, 2>&>);
static_assert(!is_taken<matrix_of_eigen<false, 1>&> && !is_taken<const matrix_of_eigen<false, 1>&>);

}  // namespace

#ifdef SSCC_WITH_EIGEN
#include <Eigen/Core>

namespace {

using by_columns = Eigen::MatrixXd;
using by_rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using strided = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;

static_assert(is_taken<Eigen::VectorXd&> && is_taken<const Eigen::VectorXd&> && is_taken<Eigen::Vector3d&>);
static_assert(is_taken<Eigen::RowVectorXd&> && is_taken<Eigen::ArrayXd&>);
static_assert(is_taken<Eigen::Map<const Eigen::VectorXd>&> && is_taken<Eigen::Ref<const Eigen::VectorXd>&>);
static_assert(is_taken<by_columns::ColXpr> && is_taken<by_columns::ConstColXpr> && is_taken<by_rows::RowXpr>);
static_assert(!is_taken<by_columns::RowXpr> && !is_taken<by_columns::ConstRowXpr> && !is_taken<by_rows::ColXpr>);
static_assert(!is_taken<strided&> && !is_taken<by_columns&> && !is_taken<by_rows&> && !is_taken<Eigen::Matrix3d&>);
static_assert(!std::is_constructible_v<sscc::view<const std::uint32_t>, Eigen::Matrix<std::uint32_t, -1, 3>&>);

}  // namespace
#endif
