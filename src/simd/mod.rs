//! stub
use crate::Implementation;
pub(crate) fn available() -> &'static [Implementation] { &[Implementation::Scalar] }
