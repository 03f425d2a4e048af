//! The results, as rows of a table and as a file.

use std::io::Write;

use indicatif::HumanCount;

use super::culler::PROBES;
use super::job::Job;
use super::measure::Sample;
use crate::Result;

/// A point and the time that each library took for it.
pub struct Row {
    pub job: Job,
    pub triangles: usize,
    pub samples: Vec<Sample>,
}

impl Row {
    fn ns_per_triangle(&self, sample: &Sample) -> f64 {
        sample.seconds * 1e9 / self.triangles as f64
    }
}

/// The heading of the table: columns for each library.
pub fn heading(libraries: &[String]) -> String {
    let mut lines = [format!("{:34}", ""), format!("{:21} {:>12}", "time against", "amount")];
    for name in libraries {
        lines[0] += &format!("  {name:>36}");
        lines[1] += &format!("  {:>10} {:>12} {:>12}", "ms", "ns/triangle", "hidden");
    }
    lines.join("\n")
}

/// A line of the table.
pub fn line(row: &Row) -> String {
    let mut line = format!("{:21} {:>12}", row.job.study.name(), HumanCount(row.job.amount.into()).to_string());
    for sample in &row.samples {
        let hidden = format!("{}/{PROBES}", sample.hidden);
        line += &format!("  {:>10.3} {:>12.2} {hidden:>12}", sample.seconds * 1e3, row.ns_per_triangle(sample));
    }
    line
}

/// The file: a row for each point and library. No name contains a comma or a quote.
pub fn write_csv(mut out: impl Write, libraries: &[String], rows: &[Row]) -> Result<()> {
    writeln!(
        out,
        "study,amount,width,height,triangles,library,milliseconds,ns_per_triangle,repeats,hidden_of_{PROBES}"
    )?;
    for row in rows {
        let Job { study, amount, size: (width, height) } = row.job;
        for (library, sample) in libraries.iter().zip(&row.samples) {
            let (ms, ns) = (sample.seconds * 1e3, row.ns_per_triangle(sample));
            let study = study.name().replace(',', "");
            write!(out, "{study},{amount},{width},{height},{},{library},", row.triangles)?;
            writeln!(out, "{ms:.6},{ns:.4},{},{}", sample.repeats, sample.hidden)?;
        }
    }
    Ok(out.flush()?)
}

#[cfg(test)]
mod tests {
    use super::super::job::jobs;
    use super::*;

    #[test]
    fn the_file_has_a_row_for_each_point_and_library() {
        let libraries = ["ours (quick; avx2)".into(), "other (avx2)".into()];
        let sample = Sample { seconds: 0.001, repeats: 5, hidden: 7 };
        let row = |job| Row { job, triangles: 2000, samples: vec![sample; 2] };
        let rows: Vec<Row> = jobs(30_000).into_iter().map(row).collect();
        let mut file = Vec::new();
        write_csv(&mut file, &libraries, &rows).unwrap();
        let lines: Vec<&str> = str::from_utf8(&file).unwrap().lines().collect();
        assert_eq!(lines.len(), 1 + 2 * (4 + 6 + 14));
        assert!(lines.iter().all(|line| line.split(',').count() == 10));
        assert_eq!(lines[1], "triangles,1000,1920,1080,2000,ours (quick; avx2),1.000000,500.0000,5,7");
        assert!(lines[48].starts_with("depth back to front,64,"), "{}", lines[48]);
        // The columns of the table are aligned with their headings.
        let heading = heading(&libraries);
        assert!(heading.lines().chain([line(&rows[0]).as_str()]).all(|l| l.len() == 34 + 2 * 38));
    }
}
