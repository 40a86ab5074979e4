//! Notes on certificates with a root radius of 0.

use sscc_tasks::ZeroRadius;

/// Maximum number of triangles in a note.
const MAX_LISTED: usize = 8;

/// Returns a note on a root's radius of 0, with the remedy.
pub fn note(reason: &ZeroRadius) -> String {
    match reason {
        ZeroRadius::Colliding { max_exceptions, can_ignore_rest } => {
            let ignore = match can_ignore_rest {
                true => ", or ignore the pairs that collide at rest with --ignore-rest",
                false => "",
            };
            format!(
                "more pairs collide at the centre than may be exceptions ({max_exceptions}): parts that contain \
                 one have radius 0; raise --max-exceptions{ignore}"
            )
        }
        ZeroRadius::Near { max_exceptions, rings } => format!(
            "more pairs are nearer than the clearance at the centre than may be exceptions ({max_exceptions}): parts that \
             contain one have radius 0; leave out more of the surface with --rings {}, choose a smaller --clearance, or raise \
             --max-exceptions",
            rings + 1
        ),
        ZeroRadius::TooClose { triangles, has_clearance: true } => format!(
            "no other pair is nearer than the clearance at the centre, but two of the triangles {} (counted from 0) are so \
             little farther apart that no radius above 0 could be proven: parts that contain both have radius 0; move them \
             apart, or choose a smaller --clearance or another --center",
            listed(triangles)
        ),
        ZeroRadius::TooClose { triangles, has_clearance: false } => format!(
            "no other pair collides at the centre, but two of the triangles {} (counted from 0) are so close that no \
             radius above 0 could be proven: parts that contain both have radius 0; move them apart, or choose \
             another --center",
            listed(triangles)
        ),
    }
}

/// Returns the numbers of triangles as text, at most [`MAX_LISTED`] of them.
fn listed(triangles: &[u32]) -> String {
    let shown: Vec<String> = triangles.iter().take(MAX_LISTED).map(u32::to_string).collect();
    let more = match triangles.len() > MAX_LISTED {
        true => format!(", ... ({} in all)", triangles.len()),
        false => String::new(),
    };
    shown.join(", ") + &more
}
