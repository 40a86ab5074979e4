# |z| is never less than the exact length: `diagonal_norm` in crates/sscc/src/model/metric/norm.rs, for up to 1024 modes.
#
# x: the exact length |S (q - c)|, the root of a sum of r squares. k t, with |k| <= 1: the relative error of the computed sum. Each
# square has five roundings (the difference q - c, the product with s, both twice, and the square), the sum at most r more; (1 + u)^(r +
# 5) - 1 <= (r + 6) u for u = 2^-53 and r <= 1024. So t = (r + 6) u, and 1 + (r + 16) 2^-52 = 1 + 2 t + 20 u. Sums below 1e-280 or above 1e280,
# where squares underflow or overflow, take another way.
#
# length >= (1 - 4 u) share x >= (1 - 4 u) (1 + 5 u) x >= x.
@rnd = float<ieee_64, ne>;

up rnd= 1 + 2 * t + 20b-53;
root rnd= x * sqrt(1 + t * k);
length rnd= root * up;
share = sqrt(1 + t * k) * up;
exact = x * sqrt(1 + t * k) * up;

{ x in [1e-141, 1e141] /\ t in [7b-53, 1030b-53] /\ k in [-1, 1]
  -> (share - 1) * 1b53 >= 5 /\ |length -/ exact| <= 4b-53 }

$ t in (10b-53, 15b-53, 22b-53, 33b-53, 50b-53, 75b-53, 110b-53, 160b-53, 240b-53, 360b-53, 540b-53, 800b-53);
