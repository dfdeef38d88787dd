//! Contradictions in the paper, with the arithmetic that reveals them.

use super::analysis::{paper_name, range};
use super::domains::DOMAINS;
use super::published::{SECONDS, SECONDS_PER_SWEEP, SWEEPS, TEXT_EDGE_IMR, row, saved};
use super::tables::percent;

/// Returns a paragraph for each contradiction.
pub(crate) fn doubts() -> Vec<String> {
    let mut list = vec![
        "**Table 1, EDGE** is printed as Lmin/Lmax, but given the range 1 to ∞ with lower values better: \
         that is Lmax/Lmin, which is taken here."
            .to_owned(),
        "**Table 1, RMS** is printed as a length, but given the range 1 to ∞. Divided by L0, the edge of an \
         equilateral triangle of the mesh's mean area (L0² = 4 Savg/√3), it has that range over the mesh, and the \
         same minimizer; that is taken here. AREA likewise is |S − Savg|/Savg."
            .to_owned(),
        "**IMR and AR are one metric.** With an equilateral reference of unit edges ‖AW⁻¹‖² = ⅔ ΣL² and \
         det(AW⁻¹) = 4S/√3, so that IMR = ‖AW⁻¹‖²/(2 det) = √3 ΣL²/(12 S) = AR. Their times can differ by how \
         they are computed alone."
            .to_owned(),
    ];
    list.extend(mechanic());
    list.extend(half());
    list.extend(aspect_ratio());
    list.extend(area_and_ar());
    list.extend(text_of_area());
    list.extend(two_quadratics());
    list
}

fn mechanic() -> Option<String> {
    let i = DOMAINS.iter().position(|d| d.name == "mechanic")?;
    let (edge, both) = (row(SECONDS, "edge")?[i], row(SECONDS, "edge+imr")?[i]);
    Some(format!(
        "**Mechanic's 40 %.** The text says that EDGE+IMR saves {:.0} % on mechanic; by Table 3 it is \
         1 − {both}/{edge} = {}. \"At least 40 %\" and the abstract's \"40–55 %\" rest on that figure: the least \
         saving in Table 3 is {}, the largest {}.",
        TEXT_EDGE_IMR[i],
        percent(1.0 - both / edge),
        percent(all_savings()?[0]),
        percent(all_savings()?[1]),
    ))
}

fn all_savings() -> Option<[f64; 2]> {
    let schemes =
        [("edge+imr", "edge"), ("edge+ar", "edge"), ("rms+imr", "rms"), ("rms+ar", "rms")];
    let mut all = Vec::new();
    for (scheme, base) in schemes {
        all.extend(saved(scheme, base)?);
    }
    Some(range(&all))
}

/// By Table 5, A makes half of the sweeps of A+B. At A's time per sweep, the sweeps by A often exceed the total time of
/// A+B.
fn half() -> Option<String> {
    let mut cases = Vec::new();
    let mut count = 0;
    for (scheme, base) in
        [("edge+imr", "edge"), ("edge+ar", "edge"), ("rms+imr", "rms"), ("rms+ar", "rms")]
    {
        let (sweeps, total) = (row(SWEEPS, scheme)?, row(SECONDS, scheme)?);
        let per_sweep = row(SECONDS_PER_SWEEP, base)?;
        for (i, domain) in DOMAINS.iter().enumerate() {
            let base_sweeps = sweeps[i].div_ceil(2);
            let least = f64::from(base_sweeps) * per_sweep[i];
            count += 1;
            if least > total[i] {
                cases.push(format!(
                    "{} on {}: {base_sweeps} × {} s = {least:.0} s > {} s",
                    paper_name(scheme),
                    domain.name,
                    per_sweep[i],
                    total[i]
                ));
            }
        }
    }
    Some(format!(
        "**The arithmetic of sweeps.** By Table 5 A+B takes as many sweeps as A, half of them (rounded up) by \
         A. At A's time per sweep, these alone take longer than the whole run of A+B in {} of {count} cases (for \
         example {}). So EDGE and RMS sweeps must have been cheaper in alternation than alone, which the \
         paper does not say, or the counts or times are not of the same runs.",
        cases.len(),
        cases.first()?
    ))
}

/// The cost of a sweep by AR differs between Tables 3 and 4.
fn aspect_ratio() -> Option<String> {
    let i = DOMAINS.iter().position(|d| d.name == "airplane")?;
    let (ar, imr) = (row(SECONDS, "edge+ar")?[i], row(SECONDS, "edge+imr")?[i]);
    let sweeps = row(SWEEPS, "edge+ar")?[i] / 2;
    let more = (ar - imr) / f64::from(sweeps);
    let whole = row(SECONDS_PER_SWEEP, "area+ar")?[i];
    Some(format!(
        "**The cost of AR.** On airplane EDGE+AR takes {ar} − {imr} = {:.1} s longer than EDGE+IMR, over \
         {sweeps} AR sweeps {more:.1} s each. By Table 5 a sweep of AREA+AR takes {whole} s on that mesh. The same \
         AR sweep cannot cost both.",
        ar - imr,
    ))
}

fn area_and_ar() -> Option<String> {
    let i = DOMAINS.iter().position(|d| d.name == "airplane")?;
    let (area, both) = (row(SECONDS_PER_SWEEP, "area")?[i], row(SECONDS_PER_SWEEP, "area+ar")?[i]);
    let ar = 2.0 * both - area;
    Some(format!(
        "**AREA and AR 1 % apart.** Alternating two solvers that differ by 1 % can save 0.5 %. For the 12–13 % of \
         Table 4 with sweeps in equal number, an AR sweep on airplane must take 2 × {both} − {area} = {ar:.3} s, {} \
         less than one of AREA.",
        percent(1.0 - ar / area)
    ))
}

/// RMS and AREA are both quadratic, so their sweeps should have similar costs.
fn two_quadratics() -> Option<String> {
    let i = DOMAINS.iter().position(|d| d.name == "airplane")?;
    let (rms, area) = (row(SECONDS_PER_SWEEP, "rms")?[i], row(SECONDS_PER_SWEEP, "area")?[i]);
    Some(format!(
        "**RMS slow, AREA fast.** In one vertex both objectives are quadratic, one Newton step is exact, and neither \
         has special derivatives; yet by Table 5 a sweep on airplane takes {rms} s and {area} s, {:.0} times as long. \
         The paper does not say why.",
        rms / area
    ))
}

fn text_of_area() -> Option<String> {
    let [low, high] = range(&saved("area+imr", "area")?);
    Some(format!(
        "**12–13 % is AREA+AR alone.** By Table 4 AREA+IMR saves {} to {}.",
        percent(low),
        percent(high)
    ))
}
