import java.io.File;
import java.io.InputStream;
import java.io.PrintStream;
import java.nio.charset.StandardCharsets;
import java.util.ArrayList;
import java.util.HashSet;
import java.util.List;
import java.util.Set;
import javax.xml.parsers.DocumentBuilderFactory;
import org.apache.poi.openxml4j.opc.OPCPackage;
import org.apache.poi.openxml4j.opc.PackageAccess;
import org.apache.poi.openxml4j.opc.PackagePart;
import org.apache.poi.openxml4j.opc.internal.PackagePropertiesPart;
import org.apache.poi.poifs.macros.VBAMacroReader;
import org.apache.poi.ss.usermodel.Cell;
import org.apache.poi.ss.usermodel.CellType;
import org.apache.poi.ss.usermodel.Row;
import org.apache.poi.ss.usermodel.Sheet;
import org.apache.poi.xssf.usermodel.XSSFCell;
import org.apache.poi.xssf.usermodel.XSSFWorkbook;
import org.apache.poi.xwpf.usermodel.XWPFDocument;
import org.apache.xmlbeans.SchemaTypeLoader;
import org.apache.xmlbeans.XmlBeans;
import org.apache.xmlbeans.XmlError;
import org.apache.xmlbeans.XmlObject;
import org.apache.xmlbeans.XmlOptions;
import org.openxmlformats.schemas.spreadsheetml.x2006.main.CTWorksheet;
import org.verapdf.gf.foundry.VeraGreenfieldFoundryProvider;
import org.verapdf.pdfa.Foundries;
import org.verapdf.pdfa.PDFAParser;
import org.verapdf.pdfa.PDFAValidator;
import org.verapdf.pdfa.flavours.PDFAFlavour;
import org.verapdf.pdfa.results.TestAssertion;
import org.verapdf.pdfa.results.ValidationResult;
import org.w3c.dom.Attr;
import org.w3c.dom.Document;
import org.w3c.dom.Element;
import org.w3c.dom.NamedNodeMap;
import org.w3c.dom.Node;
import org.w3c.dom.NodeList;

/**
 * Files judged by Apache POI (every part against the schemas of ECMA-376) and by veraPDF.
 *
 * Prints lines of fields with tabs between: "error FILE PLACE SENTENCE", "judged FILE COUNT" and,
 * of workbooks, "cell FILE SHEET ADDRESS KIND VALUE" and "macro FILE MODULE TEXT". Texts are in the form of Java literals.
 */
public final class Validate {
    private static final PrintStream OUT = new PrintStream(System.out, false, StandardCharsets.UTF_8);
    private static final String COMPATIBILITY = "http://schemas.openxmlformats.org/markup-compatibility/2006";
    private static final SchemaTypeLoader SCHEMAS =
        XmlBeans.typeLoaderUnion(CTWorksheet.type.getTypeSystem(), XmlBeans.getBuiltinTypeSystem());

    private Validate() {}

    public static void main(String[] files) throws Exception {
        VeraGreenfieldFoundryProvider.initialise();
        for (String file : files) {
            try {
                if (file.endsWith(".pdf")) {
                    pdf(file);
                } else {
                    int parts = parts(file);
                    if (file.endsWith(".docx")) {
                        try (XWPFDocument document = new XWPFDocument(OPCPackage.open(file, PackageAccess.READ))) {
                            document.getParagraphs();
                        }
                    } else {
                        cells(file);
                    }
                    if (file.endsWith(".xlsm")) {
                        macros(file);
                    }
                    say("judged", file, String.valueOf(parts));
                }
            } catch (Exception | LinkageError wrong) {
                say("error", file, "", wrong.toString());
            }
        }
        OUT.flush();
    }

    private static void say(String... fields) {
        for (int i = 0; i < fields.length; i++) {
            OUT.print(i == 0 ? "" : "\t");
            OUT.print(fields[i].replace("\\", "\\\\").replace("\t", "\\t").replace("\n", "\\n").replace("\r", "\\r"));
        }
        OUT.print("\n");
    }

    private static int parts(String file) throws Exception {
        int count = 0;
        try (OPCPackage opened = OPCPackage.open(file, PackageAccess.READ)) {
            for (PackagePart part : opened.getParts()) {
                String name = part.getPartName().getName();
                if (part instanceof PackagePropertiesPart || !name.endsWith(".xml")) {
                    continue;
                }
                List<XmlError> errors = new ArrayList<>();
                XmlObject read;
                try (InputStream stream = part.getInputStream()) {
                    read = SCHEMAS.parse(processed(stream), null, new XmlOptions());
                }
                if (read.schemaType().isNoType()) {
                    continue; // of a namespace that ECMA-376 does not describe
                }
                read.validate(new XmlOptions().setErrorListener(errors));
                count++;
                for (XmlError error : errors) {
                    say("error", file, name, error.getMessage());
                }
            }
        }
        return count;
    }

    /** A part as a reader of ECMA-376 alone sees it: without what mc:Ignorable names, and the fallback of each choice. */
    private static Document processed(InputStream stream) throws Exception {
        DocumentBuilderFactory factory = DocumentBuilderFactory.newInstance();
        factory.setNamespaceAware(true);
        factory.setFeature("http://apache.org/xml/features/disallow-doctype-decl", true);
        Document document = factory.newDocumentBuilder().parse(stream);
        Element root = document.getDocumentElement();
        Set<String> ignorable = new HashSet<>(Set.of(COMPATIBILITY));
        for (String prefix : root.getAttributeNS(COMPATIBILITY, "Ignorable").trim().split("\\s+")) {
            String namespace = prefix.isEmpty() ? null : root.lookupNamespaceURI(prefix);
            if (namespace != null) {
                ignorable.add(namespace);
            }
        }
        process(root, ignorable);
        return document;
    }

    private static void process(Element element, Set<String> ignorable) {
        NamedNodeMap attributes = element.getAttributes();
        for (int i = attributes.getLength() - 1; i >= 0; i--) {
            Attr attribute = (Attr) attributes.item(i);
            if (attribute.getNamespaceURI() != null && ignorable.contains(attribute.getNamespaceURI())) {
                element.removeAttributeNode(attribute);
            }
        }
        for (Node child = element.getFirstChild(), next; child != null; child = next) {
            next = child.getNextSibling();
            if (!(child instanceof Element part)) {
                continue;
            }
            if (COMPATIBILITY.equals(part.getNamespaceURI()) && "AlternateContent".equals(part.getLocalName())) {
                NodeList fallbacks = part.getElementsByTagNameNS(COMPATIBILITY, "Fallback");
                Node fallback = fallbacks.getLength() == 0 ? null : fallbacks.item(0);
                Node first = fallback == null ? null : fallback.getFirstChild();
                while (fallback != null && fallback.getFirstChild() != null) {
                    element.insertBefore(fallback.getFirstChild(), part);
                }
                element.removeChild(part);
                next = first == null ? next : first;
            } else if (ignorable.contains(part.getNamespaceURI())) {
                element.removeChild(part);
            } else {
                process(part, ignorable);
            }
        }
    }

    private static void cells(String file) throws Exception {
        try (XSSFWorkbook book = new XSSFWorkbook(OPCPackage.open(file, PackageAccess.READ))) {
            for (Sheet sheet : book) {
                for (Row row : sheet) {
                    for (Cell one : row) {
                        XSSFCell cell = (XSSFCell) one;
                        CellType kind = cell.getCellType();
                        boolean formula = kind == CellType.FORMULA;
                        if (formula) {
                            kind = cell.getCachedFormulaResultType();
                        }
                        String value = switch (kind) {
                            case NUMERIC -> cell.getCTCell().isSetV() && !cell.getCTCell().getV().isEmpty() ? Double.toString(cell.getNumericCellValue()) : "";
                            case STRING -> cell.getRichStringCellValue().getString();
                            case BOOLEAN -> cell.getBooleanCellValue() ? "TRUE" : "FALSE";
                            case ERROR -> cell.getErrorCellString();
                            default -> "";
                        };
                        if (!value.isEmpty()) {
                            say("cell", file, sheet.getSheetName(), cell.getReference(), kind.name(), value);
                        }
                    }
                }
            }
        }
    }

    private static void macros(String file) throws Exception {
        try (VBAMacroReader reader = new VBAMacroReader(new File(file))) {
            reader.readMacros().forEach((module, text) -> say("macro", file, module, text));
        }
    }

    private static void pdf(String file) throws Exception {
        for (PDFAFlavour flavour : new PDFAFlavour[] {PDFAFlavour.PDFA_2_A, PDFAFlavour.PDFUA_1}) {
            try (PDFAParser parser = Foundries.defaultInstance().createParser(new File(file), flavour);
                    PDFAValidator validator = Foundries.defaultInstance().createValidator(flavour, false)) {
                ValidationResult result = validator.validate(parser);
                for (TestAssertion failed : result.getTestAssertions()) {
                    say("error", file, flavour.toString() + " " + failed.getRuleId().getClause(),
                        failed.getMessage() + " at " + failed.getLocation().getContext());
                }
                say("judged", file, String.valueOf(result.getTotalAssertions()));
            }
        }
    }
}
