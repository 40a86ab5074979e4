# A radius is never more than the exact quotient of its gap and its rate: `quotient_down` in crates/sscc/src/model/rounding.rs. A
# quotient below the normal numbers is 0 there.
#
# radius <= (1 + 3 u) share a / b <= (1 + 3 u) (1 - 4 u) a / b < a / b, for u = 2^-53.
@rnd = float<ieee_64, ne>;

share = 1 - 8b-52;
quotient rnd= a / b;
radius rnd= quotient * share;
exact = a / b * share;

{ a in [1b-500, 1b500] /\ b in [1b-500, 1b500] -> (1 - share) * 1b53 >= 4 /\ |radius -/ exact| <= 3b-53 }
