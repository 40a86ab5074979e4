// All mutations: what is wrong with each, and its fate. Read by this crate, which has the wrong code, and by
// `cargo xtask mutants`, which runs the tests.
//
// `CaughtBy("TARGET TEST")`: this test must fail with the mutation and pass without it. TARGET is `lib` for the tests
// within the crate, or the name of a file in `tests/`.
// `Covered("REASON")`: another term makes up for it; the argument stands in the code.

mutants! {
    /// A search for all that can meet in a kinetic ball compares radii with |z| at its centre.
    KineticBallAtCentre: CaughtBy("kinetic radii_are_crossed_inside_a_ball");
    /// Positions about a centre are as if they were rounded at rest alone, not on the way to the centre.
    RestErrorWithoutCentre: CaughtBy("rounding positions_about_a_centre_are_rounded_on_the_way_there");
    /// Kinetic margins grant the rounding at rest alone, not that at z.
    MarginErrorAtRest: CaughtBy("rounding kinetic_margins_know_that_positions_far_from_rest_are_rounded");
    /// Radii of the pair tree are rounded to the nearest single-precision number.
    RadiusToNearest: CaughtBy("rounding radii_in_single_precision_are_no_larger");
    /// Under a dense metric positions are as if |A| rounded them, not |A||S||S^-1|.
    DenseRateOfModesAlone: CaughtBy("rounding dense_metrics_see_what_their_modes_cancel");
    /// Of a dense metric, products that cancel are not rounded up.
    DenseProductsExact: CaughtBy("lib metric::norm::tests::norm_is_at_least_the_exact_one");
    /// The inverse of the factor of a dense metric is as if it were exact.
    DenseInverseExact: CaughtBy("lib metric::triangular::tests::growth_is_at_least_the_exact_one");
    /// |z| is not rounded up.
    NormToNearest: CaughtBy("lib metric::norm::tests::norm_is_at_least_the_exact_one");
    /// Norms in bounds are not rounded up.
    NormUpToNearest: CaughtBy("lib bounds::rounding_tests::roots_are_rounded_up_and_quotients_down");
    /// Quotients of bounds are not rounded down.
    QuotientToNearest: CaughtBy("lib bounds::rounding_tests::roots_are_rounded_up_and_quotients_down");
    /// A separating direction forgets how positions at rest are rounded.
    DirectionWithoutRestError: CaughtBy("lib bounds::rounding_tests::bounds_know_that_positions_at_rest_are_rounded");
    /// A separating direction forgets how motion is rounded.
    DirectionWithoutRateError: CaughtBy("lib bounds::rounding_tests::bounds_know_that_motion_is_rounded");
    /// The bound of two nodes forgets how positions at rest are rounded.
    ClusterWithoutRestError: CaughtBy("lib bounds::rounding_tests::bounds_know_that_positions_at_rest_are_rounded");
    /// The bound of two nodes forgets how motion is rounded.
    ClusterWithoutRateError: CaughtBy("lib bounds::rounding_tests::bounds_know_that_motion_is_rounded");
    /// What the affine map of a node leaves over is as if it were exact.
    ClusterFitExact: CaughtBy("lib bounds::cluster::tests::residuals_hold_what_the_fit_has_rounded");
    /// Norms from the Gram matrix of two nodes are as if it were exact.
    ClusterProductsExact: CaughtBy("lib bounds::cluster::tests::corners_that_cancel_keep_their_rate");
    /// The affine bound forgets how motion is rounded.
    AffineWithoutRateError: CaughtBy("lib bounds::rounding_tests::bounds_know_that_motion_is_rounded");
    /// What an affine map of two triangles leaves over is as if it were exact.
    AffineResidualExact: CaughtBy("lib bounds::affine::tests::residuals_hold_what_rounding_moves_corners_by");
    /// Rates on a cone of directions are as if their Gram matrix were exact.
    ConeExact: CaughtBy("lib bounds::cone::tests::rates_that_cancel_are_not_too_small");
    /// Safe scales forget that positions on the way are rounded.
    PathExact: CaughtBy("rounding safe_scales_end_before_rounding_closes_a_gap");
    /// A |z| that equals the root's radius is certified.
    RootRadiusReached: CaughtBy("rounding a_radius_of_nothing_proves_nothing_at_the_centre");
    /// A |z| that equals a node's radius is certified in a traversal.
    NodeRadiusReached: CaughtBy("rounding a_radius_of_nothing_proves_nothing_at_the_centre");
    /// A |z| that equals the radius of two children of the root is certified.
    RootPairRadiusReached: CaughtBy("rounding a_radius_of_nothing_proves_nothing_at_the_centre");
    /// A |z| that equals a node's radius is certified in a walk of the pair tree.
    TreeNodeRadiusReached: CaughtBy("rounding a_radius_of_nothing_proves_nothing_at_the_centre");
    /// A |z| that equals the radius of a stored pair is certified.
    TreeRadiusReached: CaughtBy("pair_walk what_equals_a_radius_is_not_certified");
    /// At a |z| that equals the limit of the pair tree, what is not stored is certified.
    TreeLimitReached: CaughtBy("pair_tree absence_means_nothing_at_the_limit");
    /// Pairs that collide at the centre are not tested.
    ExceptionsForgotten: CaughtBy("pair_walk walks_find_what_brute_force_finds");
    /// Of two triangles with a common vertex only one of the edges opposite to it is bounded.
    OneHullOfTwo: CaughtBy("neighbours one_vertex_neighbours_are_found_when_asked_for");
    /// Triangles in crossing planes that touch do not collide.
    TouchingIsFree: CaughtBy("intersect edges_that_touch");
    /// Triangles are told apart in single precision with half of the slack.
    ApartSlackHalved: CaughtBy("lib query::apart::tests::positions_may_be_wrong_by_all_of_the_margin_and_sums_are_rounded");
    /// The contour test forgets all rounding.
    ContourExact: CaughtBy("lib query::contour::tests::rounding_separates_nothing_that_touches");
    /// The contour test forgets that coordinates were rounded.
    ContourCoordinatesExact: CaughtBy("lib query::contour::tests::rounding_separates_nothing_that_touches");
    /// The contour test forgets that products are rounded.
    ContourProductsExact: Covered("the second term of the error is large enough for products, too");
    /// Boxes forget that positions are rounded.
    BoxesNotWidened: CaughtBy("lib query::bd_tree::tests::boxes_contain_all_computed_positions");
    /// Positions in single precision are as if they were not quantized.
    CoarseSharesExact: CaughtBy("lib query::rough::tests::positions_are_as_near_as_they_say");
    /// Boxes of triangles in single precision are not widened by the error of positions.
    CoarseTrianglesNotWidened: CaughtBy("rounding what_touches_exactly_is_met_in_single_precision");
    /// Boxes of nodes in single precision are not widened by their error.
    CoarseNodesNotWidened: CaughtBy("lib query::bd_tree::tests::boxes_contain_all_computed_positions");
    /// The boxes of triangles on the way from one q to another are those at its start.
    SweptTrianglesAtOneEnd: CaughtBy("pair_walk walks_find_what_brute_force_finds");
    /// The boxes of nodes on the way from one q to another are those at its start.
    SweptNodesAtOneEnd: CaughtBy("lib query::bd_tree::tests::boxes_contain_the_positions_at_both_ends");
    /// The boxes in single precision of nodes on the way from one q to another are those at its start.
    SweptCoarseNodesAtOneEnd: CaughtBy("lib query::bd_tree::tests::boxes_contain_the_positions_at_both_ends");
    /// The norm of the way from one q to another is that of its end.
    SweptNormAtOneEnd: CaughtBy("continuous times_of_simple_motions");
    /// Vertices go half as far in a kinetic ball.
    BallVerticesHalfAsFar: CaughtBy("lib query::kinetic::ball::tests::vertices_stay_in_the_ball");
    /// Nodes go half as far in a kinetic ball.
    BallNodesHalfAsFar: CaughtBy("lib query::kinetic::ball::tests::vertices_stay_in_the_ball");
    /// A kinetic ball forgets that positions are rounded.
    BallExact: CaughtBy("lib query::kinetic::ball::tests::vertices_stay_in_the_ball");
    /// The way that z has gone is not rounded up.
    WayToNearest: CaughtBy("lib query::kinetic::front::tests::the_way_is_never_short");
    /// A margin that is used up exactly still holds.
    MarginReached: Covered("the end of a margin has been rounded down");
    /// Gaps of moving triangles along a direction are as if they were exact.
    SeparationExact: CaughtBy("impact_tolerance what_touches_at_the_end_is_listed");
    /// Numbers that carry an error bound forget their own rounding.
    BoundedExact: CaughtBy("lib continuous::number::tests::both_kinds_agree_with_rational_arithmetic");
    /// Pairs that rounded directions do not settle are listed at the time reached.
    FeaturesNotFollowed: CaughtBy("impact_tolerance thin_sheets_that_turn_together_are_free");
    /// Pairs of tiny triangles are not made larger.
    SmallPairsNotEnlarged: CaughtBy("impact_tolerance the_tolerance_holds_at_every_size");
    /// Tolerances of continuous tests may be below what rounding leaves of gaps.
    ToleranceBelowRounding: CaughtBy("impact_tolerance tolerances_below_rounding_do_not_end_the_search_early");
}
