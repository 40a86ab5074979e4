// The list of mutations: the error of each, and the test that catches it. Included by this crate, which contains the
// wrong code, and by `cargo xtask mutants`, which runs the tests.
//
// `CaughtBy("TARGET TEST")`: this test must fail with the mutation and pass without it. TARGET is `lib` for tests within
// the crate, `it` for those in `tests/it/`.
// `Covered("REASON")`: no test can fail, because another term is large enough; a comment in the code proves it.

mutants! {
    /// Groups of triangles are ignored: all pairs count.
    GroupsForgotten: CaughtBy("it groups::all_methods_list_the_pairs_that_count");
    /// Between two meshes groups are ignored: all pairs count.
    GroupsBetweenForgotten: CaughtBy("it groups::groups_of_several_meshes_hold_between_them");
    /// Groups of two scenes apply between a mesh of one scene and a mesh of the other.
    GroupsOfOtherScenes: CaughtBy("it groups::groups_of_several_meshes_hold_between_them");
    /// A node has the group of its first part.
    NodeGroupOfFirstPart: CaughtBy("it groups::all_methods_list_the_pairs_that_count");
    /// Vertices that are welded at rest always count as being at one position.
    WeldedVerticesStayTogether: CaughtBy("it detector::welded_vertices_can_move_apart");
    /// Two vertices of one weld class, both common by their numbers, are one common vertex.
    VertexNumbersForgotten: CaughtBy("it folded::adjacency_does_not_change_with_positions");
    /// A pair with a common edge is tested as if it were in one plane.
    HingesAreFlat: CaughtBy("it folded::folded_pairs_are_those_of_exact_fractions");
    /// Triangles with three common vertices have no other common point.
    DoubledFacesAreFree: CaughtBy("it folded::a_triangle_folded_onto_its_neighbour_is_found");
    /// If the corners of a common vertex are at two positions, the points between them count as common.
    EdgeOfOneVertexForgiven: CaughtBy("it detector::one_vertex_at_two_positions_is_no_edge");
    /// The search of a kinetic region compares radii with |z| at its start.
    KineticRegionAtCenter: CaughtBy("lib query::kinetic::tests::radii_are_crossed_inside_a_region");
    /// The rounding bound of positions about a centre omits the displacement of the centre.
    RestErrorWithoutCenter: CaughtBy("it rounding::positions_about_a_centre_are_rounded_on_the_way_there");
    /// Safe distances include the rounding error at rest, but not that at z.
    SafeDistanceErrorAtRest: CaughtBy("it rounding::kinetic_margins_know_that_positions_far_from_rest_are_rounded");
    /// Radii of the pair tree are rounded to the nearest single-precision number.
    RadiusToNearest: CaughtBy("it rounding::radii_in_single_precision_are_no_larger");
    /// The rounding bound of positions under a dense metric uses |A| in place of |A||S||S^-1|.
    DenseRateOfModesAlone: CaughtBy("it rounding::dense_metrics_bound_cancellation");
    /// In a dense metric products that cancel are not rounded up.
    DenseProductsExact: CaughtBy("lib model::metric::norm::tests::norm_is_at_least_the_exact_one");
    /// The rounding bound of a dense metric omits the error of the inverse of its factor.
    DenseInverseExact: CaughtBy("lib model::metric::triangular::tests::growth_is_at_least_the_exact_one");
    /// |z| is not rounded up.
    NormToNearest: CaughtBy("lib model::metric::norm::tests::norm_is_at_least_the_exact_one");
    /// Norms in bounds are not rounded up.
    NormUpToNearest: CaughtBy("lib bounds::tests::rounding::roots_are_rounded_up_and_quotients_down");
    /// Quotients of bounds are not rounded down.
    QuotientToNearest: CaughtBy("lib bounds::tests::rounding::roots_are_rounded_up_and_quotients_down");
    /// The bound along a separating direction omits the rounding error of rest positions (e0).
    DirectionWithoutRestError: CaughtBy("lib bounds::tests::rounding::bounds_include_rounding_of_rest_positions");
    /// The bound along a separating direction omits the rounding error of motion (e1).
    DirectionWithoutRateError: CaughtBy("lib bounds::tests::rounding::bounds_include_rounding_of_motion");
    /// The bound of two nodes omits the rounding error of rest positions (e0).
    NodePairWithoutRestError: CaughtBy("lib bounds::tests::rounding::bounds_include_rounding_of_rest_positions");
    /// The bound of two nodes omits the rounding error of motion (e1).
    NodePairWithoutRateError: CaughtBy("lib bounds::tests::rounding::bounds_include_rounding_of_motion");
    /// The affine residual of a node omits its rounding error.
    NodeFitExact: CaughtBy("lib bounds::node_modes::tests::residuals_hold_what_the_fit_has_rounded");
    /// Norms from the Gram matrix of two nodes omit its rounding error.
    NodePairProductsExact: CaughtBy("lib bounds::node_pair::tests::corners_that_cancel_keep_their_rate");
    /// The affine bound omits the rounding error of motion (e1).
    AffineWithoutRateError: CaughtBy("lib bounds::tests::rounding::bounds_include_rounding_of_motion");
    /// The affine residual of two triangles omits its rounding error.
    AffineResidualExact: CaughtBy("lib bounds::affine_fit::tests::residuals_hold_what_rounding_moves_corners_by");
    /// Closing rates on a cone of directions omit the rounding error of their Gram matrix.
    ConeExact: CaughtBy("lib bounds::cone_rate::tests::rates_that_cancel_are_not_too_small");
    /// Safe scales omit the rounding error of positions along the line.
    LineExact: CaughtBy("it rounding::safe_scales_end_before_rounding_closes_a_gap");
    /// Sweeps omit the rounding of positions between two weights.
    SweepExact: CaughtBy("it sweep::rounding_between_two_weights_is_not_forgotten");
    /// Steps of sweeps along features omit the slack.
    FeaturesWithoutSlack: CaughtBy("lib geometry::ccd::free_until::tests::directions_along_features_leave_room_for_the_slack");
    /// The ends of a narrow interval are in the order in which they were found.
    IntervalsUnordered: CaughtBy("it sweep_intervals::an_interval_narrower_than_the_tolerance_has_ordered_ends");
    /// There is no sweep between free samples.
    IntervalsBySamples: CaughtBy("it sweep_intervals::a_contact_at_one_weight_is_an_interval");
    /// The end of an interval is not searched.
    IntervalsEndWhereTheyBegin: CaughtBy("it sweep_intervals::each_plate_is_an_interval_whatever_the_samples");
    /// Only the second triangle of a pair that collides at rest has surroundings.
    SurroundingsOfOne: CaughtBy("it sweep_intervals::surroundings_are_those_of_all_triangles");
    /// Sweeps do not follow features.
    SweepFeaturesNotFollowed: CaughtBy("it near_layers::layers_that_nearly_touch_are_free_after_few_steps");
    /// A |z| that equals the root's radius is certified.
    RootRadiusReached: CaughtBy("it rounding::a_radius_of_nothing_proves_nothing_at_the_centre");
    /// A |z| that equals a node's radius is certified in a traversal.
    NodeRadiusReached: CaughtBy("it rounding::a_radius_of_nothing_proves_nothing_at_the_centre");
    /// A |z| that equals the radius of two children of the root is certified.
    RootPairRadiusReached: CaughtBy("it rounding::a_radius_of_nothing_proves_nothing_at_the_centre");
    /// A |z| that equals a node's radius is certified in a traversal of the pair tree.
    TreeNodeRadiusReached: CaughtBy("it rounding::a_radius_of_nothing_proves_nothing_at_the_centre");
    /// A |z| that equals the radius of a stored pair is certified.
    TreeRadiusReached: CaughtBy("it pair_tree_traversal::norms_equal_to_a_radius_are_not_certified");
    /// At a |z| that equals the limit of the pair tree, pairs that are not stored are certified.
    TreeLimitReached: CaughtBy("it pair_tree::absence_means_nothing_at_the_limit");
    /// Pairs that collide at the centre are not tested.
    ExceptionsForgotten: CaughtBy("it pair_tree_traversal::traversal_agrees_with_brute_force");
    /// For two triangles with a common vertex only one of the edges opposite to it is bounded.
    OneSimplexPairOfTwo: CaughtBy("it neighbours::shared_vertex_pairs_are_found_on_request");
    /// Triangles in crossing planes that touch do not collide.
    TouchingIsFree: CaughtBy("it intersect::edges_that_touch");
    /// The separating-axis test uses half of its error bound.
    SeparatingAxisErrorHalved: CaughtBy("lib detect::narrow_phase::separating_axis::tests::touching_triangles_with_errors_of_the_whole_bound_are_not_separated");
    /// The contour test omits its rounding bound.
    ContourExact: CaughtBy("lib detect::contour_test::tests::rounding_separates_nothing_that_touches");
    /// The contour test omits the rounding error of coordinates.
    ContourCoordinatesExact: CaughtBy("lib detect::contour_test::tests::rounding_separates_nothing_that_touches");
    /// The contour test omits the rounding error of products.
    ContourProductsExact: Covered("the second term of the error is large enough for products, too");
    /// Boxes omit the rounding error of positions.
    BoxesNotWidened: CaughtBy("lib detect::bd_tree::tests::boxes_contain_all_computed_positions");
    /// The error bound of positions in single precision omits quantization.
    QuantizationExact: CaughtBy("lib detect::coarse_vertices::tests::coarse_positions_are_within_their_error_bound");
    /// Boxes of triangles in single precision are not widened by the error of positions.
    CoarseTrianglesNotWidened: CaughtBy("it rounding::exact_contacts_are_found_in_single_precision");
    /// Boxes of nodes in single precision are not widened by their error.
    CoarseNodesNotWidened: CaughtBy("lib detect::bd_tree::tests::boxes_contain_all_computed_positions");
    /// Swept AABBs of triangles contain the start only.
    SweptTrianglesAtStart: CaughtBy("it pair_tree_traversal::traversal_agrees_with_brute_force");
    /// Swept AABBs of nodes contain the start only.
    SweptNodesAtStart: CaughtBy("lib detect::bd_tree::tests::boxes_contain_the_positions_at_both_ends");
    /// Swept AABBs of nodes in single precision contain the start only.
    SweptCoarseNodesAtStart: CaughtBy("lib detect::bd_tree::tests::boxes_contain_the_positions_at_both_ends");
    /// The norm of a continuous query is that of its end.
    SweptNormAtStart: CaughtBy("it continuous::times_of_simple_motions");
    /// Vertices move half as far within the radius of a capsule.
    CapsuleVerticesHalfAsFar: CaughtBy("lib query::capsule_motion::tests::vertices_stay_in_the_capsule");
    /// The radius of a moving hull omits the distance of vertices from the core points' hull.
    HullCoreExact: CaughtBy("lib query::hulls::tests::vertices_are_within_the_radius_of_their_hull");
    /// The radius of a moving hull omits the residuals of the modes.
    HullResidualForgotten: CaughtBy("lib query::hulls::tests::vertices_are_within_the_radius_of_their_hull");
    /// The bound of residuals by a few vectors omits the remainder.
    HullRemainderForgotten: CaughtBy("lib query::hulls::tests::vertices_are_within_the_radius_of_their_hull");
    /// The bound of residuals by a few vectors omits the part along the vectors.
    HullVectorsForgotten: CaughtBy("lib query::hulls::tests::vertices_are_within_the_radius_of_their_hull");
    /// Sums over the modes of residuals have no rounding error.
    HullSumsExact: CaughtBy("lib query::hulls::tests::radii_cover_sums_that_cancel");
    /// A moving hull does not stretch the distance of vertices from the core points' hull.
    HullNotStretched: CaughtBy("lib query::hulls::tests::vertices_are_within_the_radius_of_their_hull");
    /// The radius of a moving hull is that at the end of a motion.
    HullRadiusAtEnd: CaughtBy("lib query::hulls::tests::motions_and_capsules_are_covered");
    /// Hulls about a configuration move by q, not by the difference from it.
    HullWithoutConfiguration: CaughtBy("lib query::hulls::tests::vertices_are_within_the_radius_of_their_hull");
    /// The radius of a moving hull omits the error of single precision.
    HullSinglePrecisionExact: CaughtBy("lib query::hulls::tests::radii_cover_single_precision");
    /// The radius of a moving hull omits the rounding of the shape's positions.
    HullShapeExact: CaughtBy("lib query::hulls::tests::radii_cover_the_rounding_of_the_shape");
    /// Hulls in a capsule have the radius on its segment.
    HullCapsuleNotWidened: CaughtBy("lib query::hulls::tests::motions_and_capsules_are_covered");
    /// A plane separates hulls of any radius.
    HullsTouch: CaughtBy("lib query::hulls::tests::only_gaps_wider_than_the_radii_separate");
    /// The gap along a normal is compared as if the normal had length 1.
    HullNormalTakenAsUnit: CaughtBy("lib query::hulls::tests::only_gaps_wider_than_the_radii_separate");
    /// The gap of two hulls is not rounded down.
    HullGapToNearest: CaughtBy("lib query::hulls::tests::gaps_are_rounded_down");
    /// Planes are tested along normals whose squared length underflows.
    HullNormalOfAnyLength: CaughtBy("lib query::hulls::tests::gaps_are_rounded_down");
    /// Displacements are squared before they are scaled to the frame, so that squares underflow.
    HullSlackUnscaled: CaughtBy("lib query::hulls::hull_motion::tests::displacements_are_never_short_in_the_frame");
    /// A plane separates hulls only at the start of a motion.
    HullsAtStart: CaughtBy("lib query::hulls::tests::only_gaps_wider_than_the_radii_separate");
    /// Nodes move half as far within the radius of a capsule.
    CapsuleNodesHalfAsFar: CaughtBy("lib query::capsule_motion::tests::vertices_stay_in_the_capsule");
    /// The volumes of a capsule are those of a ball around its start.
    CapsuleWithoutEnd: CaughtBy("lib query::capsule_motion::tests::vertices_stay_in_the_capsule");
    /// A capsule contains all z near the line through its segment.
    SegmentWithoutEnds: CaughtBy("lib query::kinetic::region::tests::points_within_the_radius_are_contained_and_no_others");
    /// Every z counts as being in the region of the last search.
    RegionNeverLeft: CaughtBy("lib query::kinetic::tests::capsules_are_left_sideways");
    /// A motion that begins in a region counts as ending there.
    MotionLeavesRegion: CaughtBy("lib query::kinetic::tests::capsules_are_left_sideways");
    /// Motions within a region do not test pairs that collide at the centre.
    KineticExceptionsForgotten: CaughtBy("lib query::kinetic::tests::capsules_are_left_sideways");
    /// The reach of a capsule is that of its start.
    RegionReachAtStart: CaughtBy("lib query::kinetic::region::tests::points_within_the_radius_are_contained_and_no_others");
    /// Positions are computed with the first mode's coordinate in place of each listed one.
    MovingModesAreFirst: CaughtBy("lib detect::vertex_store::tests::positions_are_those_of_all_modes_bit_for_bit");
    /// The modes of a node are those of its first vertex.
    MovingModesOfOneVertex: CaughtBy("lib detect::bd_tree::tests::boxes_contain_all_computed_positions");
    /// Nodes larger than buckets do not move within the radius of a capsule.
    CapsuleInnerNodesStill: CaughtBy("lib query::capsule_motion::tests::node_volumes_contain_the_capsule");
    /// AABBs from coarse positions are those of the segment of a capsule.
    CoarseSlackForgotten: CaughtBy("lib query::capsule_motion::tests::node_volumes_contain_the_capsule");
    /// The result of a search that ends with open triangle pairs omits their bounds.
    OpenTrianglesForgotten: CaughtBy("lib certificates::build::fine_radii::tests::radii_of_touching_buckets_are_fine");
    /// A refused outer round raises the limit.
    RefusedOuterRoundComplete: CaughtBy("lib certificates::tests::below_the_limit_whatever_collides_is_open");
    /// Pairs of the outer round are free below the limit without a bound.
    OuterPairUnbounded: CaughtBy("lib certificates::tests::outer_pairs_are_bounded");
    /// Pairs of the outer round that were searched are free below the limit.
    OuterSearchForgotten: CaughtBy("lib certificates::tests::outer_pairs_are_bounded");
    /// A pair of buckets whose search ended at its cap is free up to the reach.
    CappedPairFreeToTheEnd: CaughtBy("it reach::radii_beyond_the_global_radius_are_sound");
    /// The outer round never exceeds the global radius.
    OuterRoundEndsAtGlobalRadius: CaughtBy("lib certificates::build::limit_schedule::tests::the_outer_round_passes_the_global_radius_only_from_there_and_with_room");
    /// Radii of nodes are capped at the global radius, although the pair tree reaches farther.
    RadiiCappedBelowTheTree: CaughtBy("it reach::radii_end_where_the_reach_says");
    /// After a refused round, pairs that it has split stay split.
    RefusedRoundNotUndone: CaughtBy("lib certificates::tests::below_the_limit_whatever_collides_is_open");
    /// The limit of a pair tree whose budget is full is that of its construction.
    TreeLimitNotLowered: CaughtBy("lib certificates::build::pair_tree_builder::tests::the_limit_falls_with_the_budget");
    /// A fine radius is stored for another pair.
    FineRadiusOfAnother: CaughtBy("lib certificates::build::fine_radii::tests::radii_of_touching_buckets_are_fine");
    /// A capsule omits the rounding error of positions.
    CapsuleExact: CaughtBy("lib query::capsule_motion::tests::vertices_stay_in_the_capsule");
    /// The travelled distance of z is not rounded up.
    TravelledToNearest: CaughtBy("lib query::kinetic::region_pairs::tests::the_travelled_distance_is_never_short");
    /// Safe distances still hold after a jump.
    SafeDistancesSurviveJumps: CaughtBy("lib query::kinetic::tests::answers_are_those_of_plain_queries_whatever_regions_there_are");
    /// Buckets share no vertex of many triangles.
    LargeClassForgotten: CaughtBy("lib detect::adjacency_masks::tests::buckets_that_share_a_vertex_are_neighbours");
    /// The triangles of a packet are not tested with each other.
    PacketNotTestedAgainstItself: CaughtBy("it pair_tree_traversal::traversal_agrees_with_brute_force");
    /// The triangles of a second packet that are disjoint from the first one are tested.
    PacketColumnsSwapped: CaughtBy("it pair_tree_traversal::traversal_agrees_with_brute_force");
    /// Kernels for AVX2 round a product and a sum once. Only a processor with AVX2 reaches it.
    MultiplyAddFused: CaughtBy("lib vectors::tests::bits_do_not_depend_on_the_instruction_set");
    /// A motion from one q to the next stays in the region and in safe distances if its start does.
    StepOfMotionForgotten: CaughtBy("lib query::kinetic::tests::answers_are_those_of_plain_queries_whatever_regions_there_are");
    /// A safe distance that is used up exactly still holds.
    SafeDistanceReached: Covered("the end of a safe distance has been rounded down");
    /// Gaps of moving triangles along a direction omit their rounding bound.
    SeparationExact: CaughtBy("it impact_tolerance::what_touches_at_the_end_is_listed");
    /// The error bound of a rounded number omits its own rounding.
    BoundedExact: CaughtBy("lib geometry::ccd::number_tests::both_kinds_agree_with_rational_arithmetic");
    /// Pairs that rounded directions do not settle are listed at the time reached.
    FeaturesNotFollowed: CaughtBy("it impact_tolerance::thin_sheets_that_turn_together_are_free");
    /// Pairs of tiny triangles are not made larger.
    SmallPairsNotEnlarged: CaughtBy("it impact_tolerance::the_tolerance_holds_at_every_size");
    /// Tolerances of continuous tests may be smaller than the rounding of gaps.
    ToleranceBelowRounding: CaughtBy("it impact_tolerance::tolerances_below_rounding_do_not_end_the_search_early");
    /// The point at which an edge crosses a face is computed with 106 bits even if the distances have lost all of them.
    CrossingByDoubleDoubles: CaughtBy("it intersection::determinants_that_cancel");
    /// The depth of triangles that touch without crossing is a rounding error.
    TouchingDepthRounded: CaughtBy("it penetration::on_a_grid");
    /// Every kinetic motion counts as beginning at the last q.
    MotionStartUnchecked: CaughtBy("lib query::kinetic::tests::motions_may_begin_anywhere");
    /// Two hulls count as separate if their gap is wider than the larger radius, not than the sum of both.
    LargerHullRadius: CaughtBy("lib query::hulls::tests::hulls_are_apart_only_where_their_triangles_are");
    /// The norm of an affine map is the root of the largest entry of F'F, not of the largest row sum.
    HullStretchLargestEntry: CaughtBy("lib query::hulls::moved_hulls::tests::no_vector_is_stretched_by_more_than_the_bound");
    /// A hull whose radius or map is NaN has the radius of other numbers.
    HullNanIgnored: CaughtBy("lib query::hulls::moved_hulls::tests::hulls_with_infinite_or_nan_factors_prove_nothing");
    /// The remainder of residuals is that of vectors before they are rounded to single precision.
    HullVectorsUnrounded: Covered("the relative error of sums has room for one more rounding");
    /// Residuals of hulls have no rounding error.
    HullResidualErrorForgotten: Covered("rounding up to single precision and the error of single precision are larger");
    /// The radius of a moving hull omits the rounding of positions at the configuration of the hulls.
    HullConfigurationExact: Covered("the rounding bound at q is eight times the rounding of a position at either");
    /// Safe distances have no cap.
    SafeDistanceUncapped: Covered("the rate contains the rounding of positions that are farther away");
    /// A gap that is measured at one z and used at another has one of its four rounding bounds.
    GapRoundedOnce: Covered("the roundings that the bound grants to evaluation are more than the other position's");
    /// A capsule is widened by one of five rounding bounds.
    CapsuleWidenedOnce: Covered("one bound is more than the rounding of all positions together");
    /// A safe scale may be too small for the search to advance.
    SmallestScalesSearched: CaughtBy("it safe_scale::the_smallest_scales_end");
    /// Scales at which a radius is reached are rounded to nearest.
    SafeScaleToNearest: Covered("norms are rounded up by more");
    /// A swept shape that was never placed is nowhere.
    SweptWholeUnknownAtRest: CaughtBy("lib posed::swept_shape::tests::shapes_that_were_never_placed_rest");
    /// Frames are made of infinite boxes.
    PosedFramesOfAnyBox: CaughtBy("lib posed::posed_shape::tests::infinite_boxes_change_no_answer");
    /// AABBs of posed shapes omit the rounding error of positions in the world.
    PosedAabbExact: CaughtBy("lib posed::posed_shape::tests::aabbs_contain_positions_that_the_world_rounds");
    /// Coarse positions in the world count as exact in axes of the model.
    FrameMapOfExactPositions: CaughtBy("lib posed::posed_motion::tests::coarse_positions_are_within_their_error_bound");
    /// Vertices whose coarse positions are above a plane count as not below it.
    HalfSpaceExact: CaughtBy("lib posed::half_space::tests::vertices_just_below_a_plane_are_found");
    /// All vertices of a node are displaced like their mean.
    DisplacementsOfMeans: CaughtBy("lib posed::posed_shape::tests::displacements_are_within_their_bound");
    /// Bounds of displacements omit the rounding of sums that cancel.
    DisplacementsExact: CaughtBy("lib posed::posed_shape::tests::displacements_that_cancel_are_within_their_bound");
    /// The minimum of two numbers has the smaller one of their errors.
    SmallerErrorOfTwo: CaughtBy("lib geometry::ccd::number_tests::a_minimum_has_the_larger_error");
    /// The error bound of positions in single precision is a quarter of it.
    FrameErrorQuartered: CaughtBy("lib detect::f32_frame::tests::the_error_bound_is_at_least_what_its_users_assume");
    /// A direction separates moving triangles by a quarter of their slack.
    CandidateSlackQuartered: CaughtBy("lib geometry::ccd::free_until::tests::corners_may_be_off_by_all_of_the_slack");
    /// The slack of sweeps is a quarter of it.
    SweepSlackQuartered: CaughtBy("lib query::sweep::weight_line::tests::products_that_are_rounded_apart_need_the_slack");
    /// The slack of sweeps is that of the reach at the start.
    SweepReachAtStart: CaughtBy("lib query::sweep::weight_line::tests::products_that_are_rounded_apart_need_the_slack");
    /// Along an axis in which squares of modes underflow, motion has no rounding error.
    ModeReachWithoutFloor: CaughtBy("it rounding::motions_whose_squares_underflow_are_no_rest");
    /// The limit of the outer round is not rounded to single precision.
    OuterLimitInDouble: Covered("pairs cut off at the limit are stored, too");
    /// Corners relative to one of them may be no larger than corners.
    RelativeCornersLimited: CaughtBy("it limits::corners_may_be_anywhere_in_the_range");
    /// A quotient that is NaN is a bound.
    QuotientOfNan: CaughtBy("lib model::rounding::tests::quotients_and_radii_of_nan_are_0");
    /// The larger one of a number and NaN is the number.
    MaximumIgnoresNan: CaughtBy("lib model::rounding::tests::the_larger_one_of_nan_and_a_number_is_nan");
    /// Ratios of local certificates hold for each of three rows alone, not for the largest singular value.
    LocalRowsAlone: CaughtBy("lib certificates::local::strain_search::tests::singular_values_are_at_least_exact");
    /// Images of residuals count as exact in single precision.
    LocalImagesUnrounded: CaughtBy("lib certificates::local::strain_search::tests::ratios_are_at_least_those_of_all_pairs");
    /// The distance of images from their mean is not rounded up.
    LocalSpreadToNearest: CaughtBy("lib certificates::local::strain_search::tests::images_are_within_the_spread_of_their_part");
    /// The larger one of a ratio and NaN is the ratio.
    LocalNanIgnored: CaughtBy("lib certificates::local::strain_search::tests::nan_is_the_largest_ratio");
    /// The gap of two corners is that of the centroids of their triangles.
    LocalGapOfCentroids: CaughtBy("lib certificates::local::corner_gaps::tests::gaps_do_not_exceed_exact_distances");
    /// Gaps of corners are not rounded down.
    LocalGapsExact: CaughtBy("lib certificates::local::corner_gaps::tests::gaps_do_not_exceed_exact_distances");
    /// A node with pairs that collide at the centre has no proof.
    LocalExceptionsKept: CaughtBy("it local_certificates::exceptions_do_not_spoil_the_root");
    /// The modes of a patch are those that move its first vertex.
    LocalModesOfOneVertex: CaughtBy("lib query::local_claims::tests::claims_hold_up_to_where_they_end");
    /// Images are residuals divided by W without rounding.
    LocalImagesExact: CaughtBy("lib certificates::local::residual_ellipsoid::tests::images_times_the_matrix_are_the_rows");
    /// Residuals of a patch have no rounding error.
    LocalResidualsExact: CaughtBy("lib certificates::local::build::tests::strains_are_at_least_those_of_exact_residuals");
    /// Heights of a flat patch are exact in single precision.
    LocalHeightsUnrounded: CaughtBy("lib certificates::local::build::tests::heights_are_at_most_their_share_of_gaps");
    /// Heights of a flat patch are exact in double precision.
    LocalHeightsExact: CaughtBy("lib certificates::local::build::tests::heights_are_at_most_their_share_of_gaps");
    /// The heights of a flat patch are those within its node.
    LocalHeightsOfNodeAlone: CaughtBy("lib certificates::local::build::tests::heights_are_at_most_their_share_of_gaps");
    /// The ratio with a node of a list is that of its last part.
    LocalListOfLastPart: CaughtBy("lib certificates::local::build::tests::ratios_of_lists_are_at_least_those_of_their_pairs");
    /// Ratios omit the difference between residuals and images times W.
    LocalDefectForgotten: Covered("W is no worse than its floor makes it, so ratios are rounded up by more");
    /// Nodes that one search proved are proven in the next one.
    LocalProofsKept: CaughtBy("lib query::local_proofs::tests::what_one_search_allowed_is_forgotten_in_the_next");
    /// A node is proven if its first bucket is.
    LocalProofOfOnePart: CaughtBy("lib query::local_proofs::tests::certificates_prove_their_node_and_its_pairs_with_their_list_alone");
    /// Local certificates that hold on the segment of a capsule hold in the capsule.
    LocalProofsInRegions: CaughtBy("it local_certificates::kinetic_answers_are_those_of_brute_force");
    /// F is the same in a whole region.
    LocalRegionMapStill: CaughtBy("lib query::local_inequality::tests::proofs_in_regions_hold_in_all_of_them");
    /// `W f` is the same in a whole region.
    LocalRegionStrainStill: CaughtBy("lib query::local_inequality::tests::proofs_in_regions_hold_in_all_of_them");
    /// The factors are the same in a whole region.
    LocalRegionSumStill: CaughtBy("lib query::local_inequality::tests::proofs_in_regions_hold_in_all_of_them");
    /// Without rates local certificates hold in a whole region.
    LocalRegionUnknown: CaughtBy("lib query::local_inequality::tests::regions_of_dense_metrics_have_no_proofs");
    /// Maps near their mean stretch as it does.
    LocalMotionForgotten: CaughtBy("lib query::local_inequality::tests::allowed_ratios_are_at_most_exact");
    /// The heights of a flat patch rotate with its plane for any map.
    LocalPlaneTurnsAlong: CaughtBy("lib query::local_inequality::tests::flat_patches_allow_at_most_what_is_exact");
    /// The map of a flat patch has an error in the plane, but not across it.
    LocalPlaneMapExact: CaughtBy("lib query::local_inequality::tests::flat_patches_in_regions_allow_at_most_what_is_exact");
    /// Local certificates omit the rounding of positions.
    LocalPositionsExact: CaughtBy("lib query::local_claims::tests::rounding_of_positions_far_away_closes_gaps");
    /// Boxes are widened by a quarter of a clearance.
    ClearanceHalved: CaughtBy("it clearance::near_pairs_are_those_of_all_triangles");
    /// Triangles nearer than a clearance are separated as if there were no clearance.
    ClearanceOfBoxesAlone: CaughtBy("it clearance::near_pairs_are_those_of_all_triangles");
    /// The bound along a separating direction omits the clearance.
    DirectionWithoutClearance: CaughtBy("lib bounds::tests::clearance::bounds_of_translations_are_the_distance_less_the_clearance");
    /// The affine bound omits the clearance.
    AffineWithoutClearance: CaughtBy("lib bounds::tests::clearance::bounds_of_a_contraction_are_those_of_its_distances");
    /// The bound of two nodes omits the clearance.
    NodePairWithoutClearance: CaughtBy("lib bounds::tests::clearance::bounds_of_translations_are_the_distance_less_the_clearance");
    /// Directions count as unit vectors: along a diagonal the gap of a clearance is too small.
    RequiredGapOfUnitDirections: CaughtBy("lib bounds::tests::clearance::clearances_are_measured_along_unit_directions");
    /// The gap of a clearance omits the error of distances at the centre.
    DistanceErrorAtRestForgotten: CaughtBy("lib model::required_gap::tests::gaps_hold_the_clearance_and_the_error_of_distances");
    /// The gap of a clearance omits the error of distances that grows with |z|.
    DistanceErrorOfMotionForgotten: CaughtBy("lib model::required_gap::tests::gaps_hold_the_clearance_and_the_error_of_distances");
    /// Radii with a clearance are those of pairs within the rings, too.
    RingsOfClearanceForgotten: CaughtBy("it certified_clearance::certificates_with_a_clearance_prove_nothing_about_collisions");
    /// The digest of certificates omits the clearance.
    ClearanceNotHashed: CaughtBy("it certified_clearance::another_clearance_is_refused");
    /// Certificates with a smaller clearance are used.
    SmallerClearanceUsed: CaughtBy("it certified_clearance::another_clearance_is_refused");
    /// Certificates with more rings are used.
    MoreRingsUsed: CaughtBy("it certified_clearance::another_clearance_is_refused");
    /// Certificates with a clearance prove that no pair collides.
    ClearanceProvesFree: CaughtBy("it certified_clearance::certificates_with_a_clearance_prove_nothing_about_collisions");
    /// Exceptions that do not touch are not near.
    ExceptionsOfContactsAlone: CaughtBy("it certified_clearance::near_pairs_of_the_centre_are_exceptions");
    /// With certificates boxes are widened by a quarter of a clearance.
    WidenedByHalfOfClearance: CaughtBy("it certified_clearance::near_pairs_are_the_same_with_and_without_certificates");
    /// Boxes from coarse positions are not widened by a clearance.
    CoarseBoxesOfClearanceNotWidened: CaughtBy("it certified_clearance::near_pairs_are_the_same_with_and_without_certificates");
    /// Boxes of nodes from exact bounds are not widened by a clearance.
    NodesOfClearanceNotWidened: CaughtBy("it certified_clearance::near_pairs_are_found_where_positions_must_be_exact");
    /// With certificates boxes are widened by half of a clearance, but not by the rounding of distances and coordinates.
    WidenedWithoutRounding: Covered("the rounding of AABBs of nodes, buckets and coarse positions is larger than errors of distances that occur; the bound of these errors needs the share");
    /// The error of a shared volume omits that of clips.
    VolumeWithoutClipError: CaughtBy("lib geometry::overlap_integral::tests::terms_are_within_their_error");
    /// The error of a shared volume omits that of the heights of steep planes.
    VolumeWithoutSteepError: Covered("the error of clips is at least a quarter of it, and the factor of both has room for more");
    /// Two triangles in one plane are cut along the line in which rounding makes them cross.
    OnePlaneCutInTwo: CaughtBy("lib geometry::overlap_integral::tests::terms_are_within_their_error");
    /// A slope with which heights are beyond the range of numbers is used.
    SlopeOfInfiniteHeightsKept: CaughtBy("lib geometry::overlap_integral::tests::terms_are_within_their_error");
    /// A slope beyond the range of numbers is used.
    SlopeBeyondRangeKept: CaughtBy("lib geometry::overlap_integral::tests::terms_are_within_their_error");
    /// A ball around a point outside of a body counts as inside.
    BallOutsideKept: CaughtBy("it body_penetration::the_largest_ball_is_that_of_all_planes");
    /// The largest ball in a box of centres is bounded by half the distance to the corners.
    BallBoxOfHalfSize: CaughtBy("it body_penetration::the_largest_ball_is_that_of_all_planes");
    /// The largest ball is bounded by half the distance from a triangle.
    BallCornersShrunk: CaughtBy("it body_penetration::the_largest_ball_is_that_of_all_planes");
    /// The largest ball is bounded by half the mean of two distances.
    BallMeanShrunk: CaughtBy("it body_penetration::the_largest_ball_is_that_of_all_planes");
    /// Products of the lengths of very small bodies underflow.
    SmallBodiesNotScaled: CaughtBy("it body_penetration::sizes_change_nothing");
    /// A negative shared volume is none.
    NegativeVolumeIsNone: CaughtBy("it body_penetration::parts_that_meet_in_an_edge_face_one_way");
    /// Parts of a body that meet in a vertex face as their sum does.
    PartsJoinInVertices: CaughtBy("it body_penetration::parts_that_meet_in_a_vertex_face_one_way");
    /// The points that tell where a part is may be on another part.
    PointsAtOrigins: CaughtBy("it body_penetration::parts_that_touch_face_one_way");
    /// Flat parts of a body face as rounding decides.
    FlatPartsFace: CaughtBy("it body_penetration::flat_parts_do_not_count");
    /// Heights that overflow in the frame of the search exclude all vertices.
    HalfSpaceOverflow: Covered("only a plane far below all vertices overflows downwards, and none is below it");
    /// Models have any number of modes.
    ModesWithoutLimit: CaughtBy("it resolve::invalid_input_is_refused");
    /// Parts of a body may face inward and outward.
    PartsFaceAnyWay: CaughtBy("it body_penetration::parts_face_one_way");
    /// With certificates triangles nearer than a clearance are separated as if there were no clearance.
    SeparatedWithoutClearance: CaughtBy("it certified_clearance::near_pairs_are_the_same_with_and_without_certificates");
    /// The rounding of widened boxes is not covered.
    MarginExact: CaughtBy("it clearance::small_clearances_survive_single_precision");
    /// The nearest points of two lines are computed independently.
    LinesUnprojected: CaughtBy("lib geometry::triangle_distance::tests::distances_of_nearly_parallel_edges_are_within_their_error");
    /// The result of the formula for an inside point of a needle is not checked.
    NeedlesOnce: CaughtBy("lib geometry::triangle_distance::tests::distances_to_the_inside_of_needles_are_within_their_error");
    /// The formulas of distances decide whether two triangles have a point in common.
    TouchingApart: CaughtBy("lib geometry::triangle_distance::tests::distances_are_within_their_error");
    /// A ray through a corner crosses the edges on both sides.
    CrossingsAtEnds: CaughtBy("lib geometry::crossing::tests::points_below_edges_and_corners_are_counted_once");
    /// A surface with a border has an inside.
    OpenIsClosed: CaughtBy("it clearance::enclosed_components_are_counted");
    /// Welded vertices are at one position.
    WeldsStayTogether: CaughtBy("it clearance::a_component_whose_welded_vertices_part_is_open");
    /// One further ring does not count.
    RingsOneMore: CaughtBy("it clearance::near_pairs_are_those_of_all_triangles");
    /// An answer that the maximum number of pairs cut off is no error.
    IncompleteAnswersWithoutError: CaughtBy("lib detect::detector::detector::tests::more_pairs_than_the_maximum_are_an_error");
    /// The first pair of triangles is the nearest one.
    NearestTakenFirst: CaughtBy("it clearance::the_nearest_pair_is_that_of_all_triangles");
    /// Distances of boxes are exact where they are compared with the smallest distance of triangles.
    NearestBoxesExact: CaughtBy("it clearance::distances_that_differ_by_rounding_are_told_apart");
    /// The rounding of a position along each axis is that along any direction.
    LocalErrorAlongAxes: Covered("the rounding bound of positions is eight times their error");
    /// The rounding of factors without their affine part is omitted.
    LocalAffineRounding: CaughtBy("lib query::affine_modes::tests::the_rest_of_factors_is_within_its_error");
    /// The residuals of a combination of modes are omitted.
    LocalAffineResidual: CaughtBy("lib query::affine_modes::tests::residuals_of_combinations_are_within_their_bounds");
    /// The residual of one of two points is omitted.
    LocalAffineResidualOnce: CaughtBy("lib query::affine_modes::tests::residuals_of_combinations_are_within_their_bounds");
    /// The residuals of combinations are exact.
    LocalAffineFitExact: CaughtBy("lib query::affine_modes::tests::residuals_include_their_rounding");
    /// The rounding of factors without their affine part is no strain.
    LocalAffineStrainExact: CaughtBy("lib query::local_inequality::tests::ratios_without_an_affine_part_are_at_most_exact");
    /// The map without the affine part, and that of the affine part, are exact.
    LocalAffineMapExact: CaughtBy("lib query::local_inequality::tests::ratios_without_an_affine_part_are_at_most_exact");
    /// The map of the affine part is the identity.
    LocalAffineMapForgotten: CaughtBy("lib query::local_inequality::tests::ratios_without_an_affine_part_are_at_most_exact");
    /// The residuals of affine maps close no gaps.
    LocalAffineLengthForgotten: CaughtBy("lib query::local_inequality::tests::ratios_without_an_affine_part_are_at_most_exact");
    /// `W f` in single precision is exact.
    LocalStrainExact: CaughtBy("lib query::local_inequality::tests::allowed_ratios_are_at_most_exact");
    /// F in single precision is exact.
    LocalMapExact: CaughtBy("lib query::local_inequality::tests::allowed_ratios_are_at_most_exact");
    /// The map at each end of a motion is multiplied by its own inverse rotation.
    LocalTurnAtEachEnd: CaughtBy("lib query::local_claims::tests::half_a_turn_is_no_proof");
    /// For safe scales, local certificates that hold at the end of a line count for the whole line.
    LocalScaleOfEnd: CaughtBy("it local_certificates::safe_scales_end_where_the_way_collides");
    /// If one of two ends of a motion is NaN, it is ignored.
    LocalSweptNanIgnored: CaughtBy("lib query::local_inequality::tests::nan_at_either_end_is_no_proof");
    /// The closed form of an eigenvalue is a lower bound.
    LocalEigenvalueUnproven: CaughtBy("lib query::smallest_stretch::tests::eigenvalues_of_tiny_matrices_are_lower_bounds");
    /// A certificate proves pairs of two nodes of its list.
    LocalRingWithRing: CaughtBy("lib query::local_proofs::tests::certificates_prove_their_node_and_its_pairs_with_their_list_alone");
    /// A thread that rounds upward, or ties away from zero, is accepted.
    UpwardRoundingAccepted: CaughtBy("lib arithmetic::tests::each_wrong_mode_is_recognized_by_its_results");
    /// A thread that rounds downward or to zero is accepted.
    DownwardRoundingAccepted: CaughtBy("lib arithmetic::tests::each_wrong_mode_is_recognized_by_its_results");
    /// A thread that flushes small numbers to zero is accepted.
    FlushingAccepted: CaughtBy("lib arithmetic::tests::each_wrong_mode_is_recognized_by_its_results");
    /// The root's radius proves that no pair collides, also where pairs collide at the centre.
    ExceptionsProvenFree: CaughtBy("it pair_tree_traversal::traversal_agrees_with_brute_force");
    /// The root's radius proves that no pair is near, also where pairs are near at the centre.
    NearExceptionsProvenFree: CaughtBy("it certified_clearance::near_pairs_of_the_centre_are_exceptions");
    /// The pairs near at the centre that a search tests are those that collide there.
    NearExceptionsOfContacts: CaughtBy("it certified_clearance::near_pairs_of_the_centre_are_exceptions");
    /// Terms of positions are at most as large as within the ball about the centre, wherever q is.
    ReachOfBallAnywhere: CaughtBy("lib query::valid_ball::tests::invalid_q_are_refused");
    /// Terms of positions in a ball about the centre are at most as large as at the centre.
    ReachOfBallAtCenter: CaughtBy("lib query::valid_ball::tests::every_q_in_the_ball_is_within_its_reach");
    /// The rounding of positions in a motion is that at its start.
    MotionReachAtStart: CaughtBy("lib query::configuration_search::tests::the_rounding_of_a_motion_is_that_of_both_ends");
    /// With certificates, near pairs are those beyond the rings of the first query.
    RingsOfFirstQuery: CaughtBy("it certified_clearance::near_pairs_are_the_same_with_and_without_certificates");
    /// A region contains q whose positions are rounded by more than its own.
    RegionReachUnchecked: CaughtBy("lib query::kinetic::region::tests::points_within_the_radius_are_contained_and_no_others");
    /// A region contains z with a larger |z| than that of its search.
    RegionNormUnchecked: CaughtBy("lib query::kinetic::region::tests::points_of_larger_norms_are_not_contained");
    /// The largest |z| in a capsule is not rounded up.
    RegionNormToNearest: Covered("regions contain no z with a larger |z|, whatever the rounding");
    /// A region still holds when its travel is exactly used up.
    TravelReached: Covered("the end of a travel has been rounded down");
    /// Safe distances that end within a region hold in all of it.
    SafeDistancesEndless: CaughtBy("lib query::kinetic::region_pairs::tests::pairs_expire_in_order_and_never_late");
    /// Safe distances of an earlier region hold in all of the next one.
    RememberedWithinRegion: CaughtBy("lib query::kinetic::region_pairs::tests::pairs_expire_in_order_and_never_late");
    /// The end of a motion is free, also of a motion with impacts.
    FreeEndOfAnyMotion: CaughtBy("lib query::kinetic::tests::answers_are_those_of_plain_queries_whatever_regions_there_are");
    /// In a region pairs that collide at the centre are not tested.
    KineticExceptionsUntested: CaughtBy("it kinetic::small_models_of_every_kind");
    /// Pairs whose safe distance vanishes in rounding are not tested.
    VanishingDistancesStored: CaughtBy("lib query::kinetic::tests::pairs_that_collide_at_rest_are_tested_in_every_step");
    /// The norm of a motion in a kinetic query is that of its start.
    KineticSweptNormAtStart: CaughtBy("lib query::kinetic::tests::answers_are_those_of_plain_queries_whatever_regions_there_are");
    /// Motions in a region do not test its active pairs.
    ActivePairsNotSwept: CaughtBy("lib query::kinetic::tests::answers_are_those_of_plain_queries_whatever_regions_there_are");
    /// Safe scales omit pairs that collide at the centre.
    SafeScaleWithoutExceptions: CaughtBy("it safe_scale::shapes_up_to_the_safe_scale_are_free");
    /// Pairs of nodes below pairs of buckets are free up to the limit of the pair tree.
    SafeScaleBelowBuckets: CaughtBy("it safe_scale::shapes_up_to_the_safe_scale_are_free");
    /// Triangles of two leaves that are free up to a goal are free beyond it.
    LeavesAdvancedOnce: CaughtBy("it safe_scale::shapes_up_to_the_safe_scale_are_free");
    /// Clamping ends at a |z| that equals the root's radius.
    ClampedToTheRadius: CaughtBy("it safe_scale::clamping_ends_inside_the_root_ellipsoid");
    /// Clamping promises a free q, also where pairs collide at the centre.
    ClampedWithExceptions: CaughtBy("it safe_scale::clamping_ends_inside_the_root_ellipsoid");
    /// Clamping takes radii with a clearance, which prove nothing about neighbours.
    ClampedWithClearance: CaughtBy("it certified_clearance::certificates_with_a_clearance_prove_nothing_about_collisions");
    /// Ignored pairs count if the second triangle has the smaller number.
    ExcludedInOneOrder: CaughtBy("lib filter::pair_filter::tests::ignored_pairs_have_no_order");
    /// Welded vertices are not common to their triangles.
    WeldClassesForgotten: CaughtBy("it neighbours::welded_shapes_have_the_pairs_of_shapes_without_split_vertices");
    /// A vertex that two triangles share at the start of a motion stays shared.
    MovingVertexSharedAtStart: CaughtBy("it detector::welded_vertices_can_move_apart");
    /// The time of impact of two triangles with a common vertex is that of the later one of their edges.
    LaterOfTwoTimes: CaughtBy("lib detect::narrow_phase::swept::tests::the_time_of_impact_is_that_of_the_earlier_edge");
    /// Triangles whose distance equals a clearance are near.
    ClearanceReached: CaughtBy("it certified_clearance::near_pairs_are_found_up_to_their_own_distance");
    /// AABBs that touch are disjoint.
    TouchingBoxesDisjoint: CaughtBy("it continuous::times_of_simple_motions");
    /// AABBs of pairs near at the centre count as farther apart than a clearance beyond half of it.
    FartherByHalf: CaughtBy("it certified_clearance::near_pairs_of_the_centre_are_exceptions");
    /// A direction separates moving triangles that it separates at the end.
    SeparatedAtEnd: CaughtBy("lib detect::narrow_phase::separating_axis::tests::only_triangles_that_stay_separated_are_reported");
    /// Triangles whose error is not finite are tested for separating directions.
    InfiniteErrorTested: Covered("no gap is larger than a slack that is infinite or NaN");
    /// A direction separates moving triangles of which each is on one side at the start and on the other side at the end.
    SidesOfEndsDiffer: CaughtBy("lib detect::narrow_phase::separating_axis::tests::only_triangles_that_stay_separated_are_reported");
    /// Coarse places that exceed 32 bits are used.
    CoarsePlacesWrap: CaughtBy("lib detect::coarse_vertices::tests::places_are_numbers_of_32_bits");
    /// Unused lanes of the separating-axis test keep the corners of an earlier search.
    UnusedLanesKept: CaughtBy("it detector::one_mesh_is_tested_against_meshes_of_other_sizes");
    /// A search begins with the pairs that a panic has left.
    CandidatesOfLastSearch: CaughtBy("lib detect::search::tests::a_search_begins_without_the_pairs_that_a_panic_left");
    /// The last pairs of two buckets, fewer than eight, are not tested.
    LastCandidatesForgotten: CaughtBy("it detector::one_mesh_is_tested_against_meshes_of_other_sizes");
    /// A bucket shares no vertex with itself if the two buckets before shared none.
    SharedVerticesOfLastBuckets: CaughtBy("it pair_tree_traversal::traversal_agrees_with_brute_force");
    /// The error of the second of two shapes is that of the first one.
    ErrorOfFirstShape: CaughtBy("lib posed::posed_shape::tests::each_shape_has_its_own_error");
    /// Sides of normals have no rounding error.
    ConeSidesExact: CaughtBy("lib detect::normal_cones::tests::certain_sides_are_right");
    /// The normals of a node are those of its last child.
    ConeOfLastChild: CaughtBy("it normal_cones::a_fold_inside_of_a_flat_sheet_is_found");
    /// Each of two meshes is searched in its own frame.
    FramesOfTheirOwn: CaughtBy("it detector::pairs_of_two_meshes_are_those_of_brute_force");
    /// The nearest two triangles are not within one node.
    NearestBetweenNodesAlone: CaughtBy("it clearance::the_nearest_pair_is_that_of_all_triangles");
    /// A ray upward from within a box crosses nothing in it.
    RaysMissTheirBoxes: CaughtBy("it clearance::enclosed_components_are_counted");
    /// An open mesh is not inside a closed one.
    OneOpenMeshHasNone: CaughtBy("it clearance::enclosed_components_are_counted");
    /// A ray crosses only edges that run upward.
    CrossingsUpwardAlone: CaughtBy("lib geometry::crossing::tests::points_below_edges_and_corners_are_counted_once");
    /// A ball inside of the second body is inside of both.
    BallInsideSecond: CaughtBy("it body_penetration::the_largest_ball_is_that_of_all_planes");
    /// The AABB of a posed motion is that of its start.
    SweptWholeAtStart: CaughtBy("lib posed::swept_shape::tests::impacts_are_those_of_all_triangles");
    /// AABBs of nodes in the world are those at the start of a motion.
    PosedNodesAtStart: CaughtBy("lib posed::swept_shape::tests::impacts_are_those_of_all_triangles");
    /// Nodes and triangles in the world are not widened by the margin of near pairs.
    PosedMarginForgotten: CaughtBy("lib posed::swept_shape::tests::impacts_are_those_of_all_triangles");
    /// AABBs from coarse positions in the world are not widened by a margin.
    PosedCoarseWithMargin: Covered("the error of coarse positions contains the margin");
    /// Positions of a posed shape in axes of the model are exact.
    PosedOwnRoundingForgotten: Covered("the rounding bound in the world contains it");
    /// A shape whose q stays the same stays at its place.
    PlacedByCoordinatesAlone: CaughtBy("lib posed::posed_shape::tests::each_shape_has_its_own_error");
    /// AABBs of an earlier place are used while the frame stays the same.
    PosedVolumesKept: CaughtBy("lib posed::posed_shape::tests::shapes_move_within_one_frame");
    /// AABBs with an earlier margin are used while the frame stays the same.
    NearMarginKept: CaughtBy("lib posed::swept_shape::tests::motions_and_margins_change_within_one_frame");
    /// AABBs of a swept shape stay those of the motion before.
    SweptVolumesKept: CaughtBy("lib posed::swept_shape::tests::motions_and_margins_change_within_one_frame");
    /// Each of two shapes is widened by a quarter of the margin of near pairs.
    NearMarginHalved: CaughtBy("lib posed::swept_shape::tests::motions_and_margins_change_within_one_frame");
    /// The height of a plane in the frame of a search has no rounding error.
    HalfSpaceFrameExact: Covered("the error of positions in the world is larger");
    /// Weights before a time of impact are rounded to nearest.
    WeightBeforeToNearest: CaughtBy("lib query::sweep::weight_line::tests::weights_are_rounded_towards_the_start");
    /// The share of an interval of weights before a time of impact is rounded to nearest.
    WeightShareToNearest: CaughtBy("lib query::sweep::weight_line::tests::weights_are_rounded_towards_the_start");
    /// The norm of an interval of weights is that at its start.
    SweepNormAtStart: CaughtBy("it sweep::contacts_of_simple_shapes");
    /// If an interval has too many candidates, those that were found count as all.
    SweepCutOffIsFree: CaughtBy("lib query::sweep::work::tests::limited_sweeps_end_at_a_weight_up_to_which_the_shape_is_free");
    /// A configuration whose first colliding pair does not count is free.
    ResolvedByFirstPair: CaughtBy("it resolve::answers_are_free_and_no_farther_than_stepping_back");
    /// Half-spaces take the weights of the first modes for those of the modes that move their corners.
    HalfSpacesOfFirstModes: CaughtBy("lib query::resolve::separations::tests::modes_that_move_other_triangles_change_no_half_space");
    /// The bound of a pair of nodes is that of its first part.
    ParentOfFirstChild: CaughtBy("lib certificates::tests::below_the_limit_whatever_collides_is_open");
    /// Pairs of buckets that were bounded do not limit the radius of a node.
    FrontierBoundedForgotten: CaughtBy("it certificates::certified_implies_free");
    /// The radius of a node is that of the pairs of its children, not of the children.
    RadiusOfPairsAlone: CaughtBy("it certificates::certified_implies_free");
    /// A refused round raises the limit.
    RefusedInnerRoundComplete: CaughtBy("lib certificates::build::limit_schedule::tests::a_refused_limit_is_not_reached");
    /// The bound of two triangles with a common vertex is that of one of the edges opposite to it.
    LeafPairOfFirstSimplices: CaughtBy("it neighbours::shared_vertex_pairs_are_found_on_request");
    /// Pair trees with radii at their limit are accepted.
    TreeRadiusAtLimitAccepted: CaughtBy("it pair_tree::damaged_trees_are_refused");
    /// Pair trees with a radius above that of a part are accepted.
    TreeRadiusAboveChildAccepted: CaughtBy("it pair_tree::damaged_trees_are_refused");
    /// Certificates with a radius of a node above that of a part are accepted.
    NodeRadiusAboveChildAccepted: CaughtBy("it certificates::damaged_parts_are_refused");
    /// Certificates with a radius that is NaN are accepted.
    NanRadiusAccepted: CaughtBy("it certificates::damaged_parts_are_refused");
    /// The gap of two parts is that of the sphere of one to the centre of the other.
    LocalSphereOfOne: CaughtBy("lib certificates::local::strain_search::tests::ratios_are_at_least_those_of_all_pairs");
    /// The ratio of two parts has the spread of one of them.
    LocalSpreadOfOne: CaughtBy("lib certificates::local::strain_search::tests::ratios_of_parts_that_are_not_divided_are_at_least_those_of_their_pairs");
    /// The ratio of parts that are not divided is forgotten.
    LocalAcceptedForgotten: CaughtBy("lib certificates::local::strain_search::tests::ratios_of_parts_that_are_not_divided_are_at_least_those_of_their_pairs");
    /// The gap of parts that are not divided is forgotten.
    LocalAcceptedGapForgotten: CaughtBy("lib certificates::local::strain_search::tests::ratios_of_parts_that_are_not_divided_are_at_least_those_of_their_pairs");
    /// Triangles without a gap at the centre have a ratio.
    LocalTouchingFree: CaughtBy("lib certificates::local::strain_search::tests::triangles_without_a_gap_have_no_ratio");
    /// Gaps along the line between two parts are rounded to nearest.
    LocalComponentsToNearest: Covered("quotients by gaps are rounded up by more");
    /// Gaps of a table are longer by as much as they should be shorter.
    LocalTableLonger: CaughtBy("lib certificates::local::corner_gaps::tests::stored_gaps_do_not_exceed_exact_distances");
    /// Certificates may have more numbers than 32 bits address.
    LocalAddressesUnlimited: CaughtBy("lib certificates::local::validation::tests::starts_have_32_bits");
    /// Certificates may take more memory than 32-bit starts address.
    LocalBytesUnlimited: CaughtBy("lib certificates::local::build::tests::starts_of_kept_certificates_have_32_bits");
    /// A pair of images is skipped though its ratio may be above the largest by the rounding of its distance.
    LocalLimitsWidened: CaughtBy("lib certificates::local::strain_search::tests::ratios_just_above_the_largest_are_found");
    /// The residuals of a fit are those of another affine map.
    AffineResidualOfOtherMap: CaughtBy("lib bounds::affine_fit::tests::residuals_are_those_of_the_gradient");
    /// Gaps in tables are rounded to nearest.
    LocalTableToNearest: Covered("gaps are shortened by a larger share before");
    /// After the last number of a search the marks of the first ones hold again.
    LocalSearchesWrap: CaughtBy("lib query::local_proofs::tests::what_one_search_allowed_is_forgotten_in_the_next");
    /// A ratio that equals the allowed one is proven.
    LocalRatioReached: Covered("allowed ratios have been rounded down");
    /// Rates whose squares underflow are as small as computed.
    RegionRatesUnderflow: CaughtBy("lib query::region_rates::tests::singular_values_are_bounded");
    /// A direction that turns separates moving triangles if it separates them at both ends.
    TurningByEnds: CaughtBy("lib geometry::ccd::candidate_direction::tests::turning_directions_are_tested_between_both_ends");
    /// A plane separates moving triangles that it separates at the end.
    PlanesAtEnd: CaughtBy("it continuous::times_of_simple_motions");
    /// A direction that separates two vertices separates them until the end.
    SeparatedForever: CaughtBy("it continuous::times_of_simple_motions");
    /// A direction along features separates moving triangles that it separates at the end of a step.
    FeaturesByEnds: CaughtBy("lib geometry::ccd::feature_direction::tests::feature_directions_are_tested_in_the_whole_interval");
}
