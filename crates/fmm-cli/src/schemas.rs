//! Schemas of the documents, which are kept in `docs/schemas`.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;

use crate::answer::Document;
use crate::refusal::Refused;
use crate::{backbone, batch, budget, design, force, frf, identify, lists, scenario};

/// Name and schema of a document.
fn schema<T: JsonSchema>(name: &str) -> (String, String) {
    let generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let mut schema = generator.into_root_schema_for::<Document<T>>().to_value();
    schema["title"] = format!("fmm {name}").into();
    schema["properties"]["schema"]["const"] = name.into();
    (name.to_owned(), format!("{schema:#}\n"))
}

fn schemas() -> Vec<(String, String)> {
    vec![
        schema::<identify::Content<'_>>("identify-1"),
        schema::<force::Content<'_>>("force-1"),
        schema::<backbone::Content<'_>>("backbone-1"),
        schema::<frf::Content<'_>>("frf-1"),
        #[cfg(feature = "modes")]
        schema::<frf::modes::Content<'_>>("modes-1"),
        schema::<budget::Answers>("budget-1"),
        schema::<scenario::Motion>("simulate-1"),
        schema::<design::Choice>("design-1"),
        schema::<batch::Content<'_>>("batch-1"),
        schema::<batch::Part>("part-1"),
        schema::<lists::Laws>("laws-1"),
        schema::<lists::Formats>("formats-1"),
        schema::<Refused<'_>>("error-1"),
    ]
}

/// The schemas in `docs/schemas` are those of the types; with `FMM_SCHEMAS=write` they are written.
#[test]
fn schemas_are_those_of_the_types() {
    let folder: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/schemas");
    for (name, schema) in schemas() {
        let path = folder.join(format!("{name}.json"));
        if std::env::var("FMM_SCHEMAS").is_ok_and(|how| how == "write") {
            std::fs::write(&path, &schema).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let hint = "FMM_SCHEMAS=write cargo test -p fmm-cli --lib schemas writes it anew";
        assert!(kept == schema, "{} is not that of the type; {hint}", path.display());
    }
}
