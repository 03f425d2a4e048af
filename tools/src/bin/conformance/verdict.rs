//! The results for all requested APIs, and the exit status.

/// The result for one API.
pub struct Outcome {
    pub api: &'static str,
    /// Triangles compared, and pixels that differed, including those before a failure.
    pub triangles: u64,
    pub differences: u64,
    /// Why it could not be opened or compared completely.
    pub failure: Option<String>,
}

impl Outcome {
    fn tell(&self) -> String {
        let (api, triangles) = (self.api, self.triangles);
        let seen = match self.differences {
            0 => format!("no pixel differs in {triangles} triangles"),
            n => format!("FAILED, {n} pixels differ in {triangles} triangles"),
        };
        match &self.failure {
            None => format!("{api}: {seen}"),
            Some(why) if triangles == 0 => format!("{api}: not compared: {why}"),
            Some(why) => format!("{api}: {seen}, then it broke off: {why}"),
        }
    }
}

/// One line for each requested API, and the exit status: 1 if a pixel differs, otherwise 2 if one of them was not
/// compared completely, so that a missing driver never passes for one that agrees.
pub fn verdict(outcomes: &[Outcome]) -> (Vec<String>, u8) {
    let mut lines: Vec<String> = outcomes.iter().map(Outcome::tell).collect();
    if outcomes.iter().all(|o| o.triangles == 0) {
        lines.push("nothing could be compared".to_owned());
    }
    let status = if outcomes.iter().any(|o| o.differences > 0) {
        1
    } else if lines.len() > outcomes.len() || outcomes.iter().any(|o| o.failure.is_some()) {
        2
    } else {
        0
    };
    (lines, status)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(api: &'static str, triangles: u64, differences: u64, failure: Option<&str>) -> Outcome {
        Outcome { api, triangles, differences, failure: failure.map(str::to_owned) }
    }

    #[test]
    fn two_that_agree_are_a_success() {
        let (lines, status) = verdict(&[outcome("Vulkan", 9, 0, None), outcome("OpenGL", 9, 0, None)]);
        assert_eq!((lines.len(), status), (2, 0));
    }

    #[test]
    fn differences_outlive_an_api_that_does_not_open() {
        let missing = || outcome("OpenGL", 0, 0, Some("no device"));
        let (lines, status) = verdict(&[outcome("Vulkan", 9, 5, None), missing()]);
        assert_eq!(status, 1);
        assert_eq!(lines, ["Vulkan: FAILED, 5 pixels differ in 9 triangles", "OpenGL: not compared: no device"]);
        // In either order.
        assert_eq!(verdict(&[missing(), outcome("Vulkan", 9, 5, None)]).1, 1);
    }

    #[test]
    fn a_missing_api_is_no_success() {
        let (lines, status) = verdict(&[outcome("Vulkan", 0, 0, Some("no loader")), outcome("OpenGL", 9, 0, None)]);
        assert_eq!(status, 2);
        assert_eq!(lines, ["Vulkan: not compared: no loader", "OpenGL: no pixel differs in 9 triangles"]);
    }

    #[test]
    fn nothing_compared_is_said() {
        let (lines, status) = verdict(&[outcome("Vulkan", 0, 0, Some("no loader"))]);
        assert_eq!(status, 2);
        assert_eq!(lines.last().unwrap(), "nothing could be compared");
    }

    #[test]
    fn what_was_counted_before_breaking_off_stays() {
        let (lines, status) = verdict(&[outcome("Vulkan", 9, 5, Some("device lost"))]);
        assert_eq!(status, 1);
        assert_eq!(lines, ["Vulkan: FAILED, 5 pixels differ in 9 triangles, then it broke off: device lost"]);
        assert_eq!(verdict(&[outcome("Vulkan", 9, 0, Some("device lost"))]).1, 2);
    }
}
